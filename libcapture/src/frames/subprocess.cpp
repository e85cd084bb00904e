#include "subprocess.h"

#include "doublet/core/error.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

namespace doublet::detail {
namespace {

/// Of a pipe, neither of whose ends a program inherits that is started meanwhile.
struct Pipe {
  int read = -1, write = -1;
  Pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC)) // at once: another thread may start a program now
      throw Error(std::string("a pipe cannot be opened (") + std::strerror(errno) + ")");
    // Above the three of every program, and above 3: the ends are copied there.
    read = fcntl(ends[0], F_DUPFD_CLOEXEC, 10);
    write = fcntl(ends[1], F_DUPFD_CLOEXEC, 10);
    close(ends[0]);
    close(ends[1]);
  }
  ~Pipe() {
    for (const int end : {read, write})
      if (end >= 0)
        close(end);
  }
  Pipe(const Pipe &) = delete;
  Pipe &operator=(const Pipe &) = delete;

  std::FILE *reader() {
    std::FILE *file = read < 0 ? nullptr : fdopen(read, "rb");
    if (!file)
      throw Error(std::string("a pipe cannot be read (") + std::strerror(errno) + ")");
    read = -1;
    return file;
  }
};

class Actions {
public:
  Actions() {
    posix_spawn_file_actions_init(&files);
    posix_spawnattr_init(&attributes);
  }
  ~Actions() {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  }
  Actions(const Actions &) = delete;
  Actions &operator=(const Actions &) = delete;

  /// A group of its own, and signals as a program expects them: Python, for one, ignores SIGPIPE.
  void separate() {
    sigset_t usual, none;
    sigemptyset(&none);
    sigemptyset(&usual);
    sigaddset(&usual, SIGPIPE);
    posix_spawnattr_setsigdefault(&attributes, &usual);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  }

  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
};

} // namespace

Subprocess::Subprocess(const std::vector<std::string> &command, const std::string &advice) : complaints_(std::tmpfile()) {
  if (!complaints_)
    throw Error(std::string("a temporary file cannot be opened (") + std::strerror(errno) + ")");
  Pipe output, notes;
  Actions actions;
  actions.separate();
  posix_spawn_file_actions_addopen(&actions.files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions.files, output.write, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions.files, fileno(complaints_.get()), STDERR_FILENO);
  posix_spawn_file_actions_adddup2(&actions.files, notes.write, 3);
  std::vector<char *> arguments;
  for (const std::string &argument : command)
    arguments.push_back(const_cast<char *>(argument.c_str()));
  arguments.push_back(nullptr);
  output_.reset(output.reader());
  notes_.reset(notes.reader());
  if (const int failed = posix_spawnp(&process_, arguments[0], &actions.files, &actions.attributes, arguments.data(), environ)) {
    process_ = -1;
    if (failed == ENOENT)
      throw Error("the program " + command[0] + " is not installed" + (advice.empty() ? "" : "; " + advice));
    throw Error("the program " + command[0] + " cannot be started (" + std::strerror(failed) + ")");
  }
}

Subprocess::~Subprocess() {
  if (process_ > 0) {
    kill(process_, SIGKILL);
    wait();
  }
}

bool Subprocess::wait() {
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR)
    ;
  process_ = -1;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string Subprocess::complaint() {
  std::rewind(complaints_.get());
  char line[400] = "";
  if (!std::fgets(line, sizeof line, complaints_.get()))
    return "";
  line[std::strcspn(line, "\n")] = '\0';
  return line;
}

} // namespace doublet::detail
