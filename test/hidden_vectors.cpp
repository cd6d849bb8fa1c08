// Linked into a program with -Wl,--wrap=__cpu_indicator_init: hides the features in PLATOON_HIDDEN from the program's
// choice of vector widths, so that a test can force each width. libgcc detects the features of the processor.

namespace {
// Feature bits in libgcc's interface, which do not change.
constexpr unsigned kAvx2 = 1u << 10, kFma = 1u << 14, kAvx512 = 1u << 15;
}  // namespace

extern "C" {
struct {
  unsigned vendor, type, subtype, features;
} extern __cpu_model;

int __real___cpu_indicator_init();
int __wrap___cpu_indicator_init();

int __wrap___cpu_indicator_init() {
  const int status = __real___cpu_indicator_init();
  __cpu_model.features &= ~(PLATOON_HIDDEN);
  return status;
}

// The only call in a program whose loader selects no versions, as with sanitizers.
__attribute__((constructor)) void hide() {
  __wrap___cpu_indicator_init();
}
}
