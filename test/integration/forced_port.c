// Preloaded: binds the XML-RPC server of the next node that starts to the port in the file named by FORCED_PORT, and removes the file.
// A program that executes itself again is delayed, so that others connect to it meanwhile.

#define _GNU_SOURCE
#include <arpa/inet.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

int bind(int socket, const struct sockaddr* address, socklen_t size) {
  int (*const real)(int, const struct sockaddr*, socklen_t) =
      (int (*)(int, const struct sockaddr*, socklen_t))dlsym(RTLD_NEXT, "bind");
  const char* name = getenv("FORCED_PORT");
  Dl_info caller;
  FILE* file = NULL;
  if (name && dladdr(__builtin_return_address(0), &caller) && strstr(caller.dli_fname, "xmlrpcpp")) file = fopen(name, "r");
  struct sockaddr_storage forced;
  memset(&forced, 0, sizeof forced);
  memcpy(&forced, address, size < sizeof forced ? size : sizeof forced);
  int port = 0;
  if (file) {
    if (fscanf(file, "%d", &port) == 1) ((struct sockaddr_in*)&forced)->sin_port = htons((unsigned short)port);
    fclose(file);
    unlink(name);
    // Another connection may use the port for a while. A node whose server has no port would never receive a call.
    for (int attempt = 0; port && attempt < 50; ++attempt) {
      if (real(socket, (const struct sockaddr*)&forced, size) == 0) return 0;
      usleep(20000);
    }
  }
  return real(socket, address, size);
}

int execv(const char* path, char* const arguments[]) {
  int (*const real)(const char*, char* const[]) = (int (*)(const char*, char* const[]))dlsym(RTLD_NEXT, "execv");
  if (strcmp(path, "/proc/self/exe") == 0) usleep(300000);
  return real(path, arguments);
}
