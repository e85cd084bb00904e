#pragma once

#include "doublet/core/finding.h"
#include "doublet/options/options.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace doublet::detail {

using Json = nlohmann::ordered_json; // as a person would write it, in the order of the work

/// Names of files may be any bytes: what is no UTF-8 in them is U+FFFD.
inline std::string text_of(const Json &json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

/// Of a summary: what the next reader wants to know of findings.
inline Json to_json(const std::vector<Finding> &findings) {
  Json list = Json::array();
  for (const Finding &finding : findings)
    list.push_back({{"impossible", finding.impossible}, {"text", finding.text}, {"kind", finding.kind}});
  return list;
}

} // namespace doublet::detail
