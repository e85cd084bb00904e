#pragma once

#include "doublet/core/finding.h"
#include "doublet/options/options.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace doublet::detail {

using Json = nlohmann::ordered_json; // as a person would write it, in the order of the work

/// Of a summary: what the next reader wants to know of findings.
inline Json to_json(const std::vector<Finding> &findings) {
  Json list = Json::array();
  for (const Finding &finding : findings)
    list.push_back({{"impossible", finding.impossible}, {"text", finding.text}, {"kind", finding.kind}});
  return list;
}

} // namespace doublet::detail
