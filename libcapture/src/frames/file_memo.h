#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>

namespace doublet::detail {

/// What this process has found out about files, kept while they stay as they are: every stage opens a session's videos anew.
template <class Found> class FileMemo {
public:
  /// What `find` returns about the file where it is asked `question`. What it throws is not kept.
  template <class Find> Found of(const std::filesystem::path &path, const std::string &question, const Find &find) {
    std::error_code none; // of what is no file, which `find` says
    const Key key(std::filesystem::absolute(path, none), std::filesystem::file_size(path, none),
                  std::filesystem::last_write_time(path, none), question);
    {
      const std::lock_guard lock(mutex_);
      if (const auto known = known_.find(key); known != known_.end())
        return known->second;
    }
    Found found = find();
    const std::lock_guard lock(mutex_);
    return known_.emplace(key, std::move(found)).first->second;
  }

private:
  using Key = std::tuple<std::filesystem::path, std::uintmax_t, std::filesystem::file_time_type, std::string>;
  std::mutex mutex_;
  std::map<Key, Found> known_;
};

} // namespace doublet::detail
