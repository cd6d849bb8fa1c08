#include "stochastic_platoon/run/io/process_identity.hpp"

#include <unistd.h>

#include <ctime>
#include <fstream>
#include <sstream>

namespace platoon {

std::string present_kernel() {
  std::string boot = "unknown";
  std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
  char space[64];
  const ssize_t length = ::readlink("/proc/self/ns/pid", space, sizeof space);
  return boot + "," + (length > 0 ? std::string(space, static_cast<std::size_t>(length)) : "unknown");
}

std::optional<ProcessIdentity> process_identity(pid_t number) {
  std::ifstream file("/proc/" + std::to_string(number) + "/stat");
  std::string text;
  if (!std::getline(file, text, '\0')) return std::nullopt;
  // The name, in parentheses, may contain any character; the state is the third field, the start the 22nd.
  const std::size_t end_of_name = text.rfind(')');
  if (end_of_name == std::string::npos) return std::nullopt;
  std::istringstream fields(text.substr(end_of_name + 1));
  std::string field;
  for (int n = 3; n <= 22; ++n) {
    if (!(fields >> field)) return std::nullopt;
    if (n == 3 && (field == "Z" || field == "X")) return std::nullopt;  // the process has ended
  }
  return ProcessIdentity{number, std::stoull(field), present_kernel()};
}

bool lives(const ProcessIdentity& process) {
  const std::optional<ProcessIdentity> found = process_identity(process.number);
  return found && found->start == process.start && found->kernel == process.kernel;
}

double seconds_since_boot() {
  timespec time{};
  ::clock_gettime(CLOCK_BOOTTIME, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace platoon
