// Preloaded: adds the number of nanoseconds (8 bytes) in the file named by SHIFTED_CLOCK to the time of day. Writing to the file makes the
// clock jump for every process that has this library. Waits until a time of day end at the same moment as without it.

#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static const volatile int64_t none = 0;
static const volatile int64_t* shift = &none;  // [ns]

__attribute__((constructor)) static void map_shift(void) {
  const char* name = getenv("SHIFTED_CLOCK");
  const int file = name ? open(name, O_RDONLY | O_CLOEXEC) : -1;
  if (file < 0) return;
  void* page = mmap(NULL, sizeof(int64_t), PROT_READ, MAP_SHARED, file, 0);
  if (page != MAP_FAILED) shift = page;
  close(file);
}

static struct timespec moved(struct timespec time, int64_t by) {
  const int64_t all = time.tv_sec * INT64_C(1000000000) + time.tv_nsec + by;
  time.tv_sec = all / 1000000000;
  time.tv_nsec = all % 1000000000;
  return time;
}

static struct timespec present(void) {
  static int (*real)(clockid_t, struct timespec*);
  if (!real) real = (int (*)(clockid_t, struct timespec*))dlsym(RTLD_NEXT, "clock_gettime");
  struct timespec time;
  real(CLOCK_REALTIME, &time);
  return moved(time, *shift);
}

int clock_gettime(clockid_t clock, struct timespec* time) {
  static int (*real)(clockid_t, struct timespec*);
  if (!real) real = (int (*)(clockid_t, struct timespec*))dlsym(RTLD_NEXT, "clock_gettime");
  if (clock != CLOCK_REALTIME && clock != CLOCK_REALTIME_COARSE) return real(clock, time);
  *time = present();
  return 0;
}

int gettimeofday(struct timeval* restrict time, void* restrict zone) {
  (void)zone;
  const struct timespec now = present();
  time->tv_sec = now.tv_sec;
  time->tv_usec = now.tv_nsec / 1000;
  return 0;
}

time_t time(time_t* time) {
  const struct timespec now = present();
  if (time) *time = now.tv_sec;
  return now.tv_sec;
}

// Small values are times since the start of the machine, which do not shift.
static struct timespec unshifted(const struct timespec* until) {
  return until->tv_sec > 1000000000 ? moved(*until, -*shift) : *until;
}

int pthread_cond_timedwait(pthread_cond_t* restrict condition, pthread_mutex_t* restrict mutex, const struct timespec* restrict until) {
  static int (*real)(pthread_cond_t*, pthread_mutex_t*, const struct timespec*);
  if (!real) real = (int (*)(pthread_cond_t*, pthread_mutex_t*, const struct timespec*))dlvsym(RTLD_NEXT, "pthread_cond_timedwait", "GLIBC_2.3.2");
  if (!real) real = (int (*)(pthread_cond_t*, pthread_mutex_t*, const struct timespec*))dlsym(RTLD_NEXT, "pthread_cond_timedwait");
  const struct timespec end = unshifted(until);
  return real(condition, mutex, &end);
}

int sem_timedwait(sem_t* restrict semaphore, const struct timespec* restrict until) {
  static int (*real)(sem_t*, const struct timespec*);
  if (!real) real = (int (*)(sem_t*, const struct timespec*))dlsym(RTLD_NEXT, "sem_timedwait");
  const struct timespec end = unshifted(until);
  return real(semaphore, &end);
}
