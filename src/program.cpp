// The entry point of every program. PLATOON_PROGRAM names the program's function, in src/nodes or src/tools: these are
// libraries, so that all nodes, and all tools, compile at once (CMAKE_UNITY_BUILD).

int PLATOON_PROGRAM(int argc, char** argv);

int main(int argc, char** argv) {
  return PLATOON_PROGRAM(argc, argv);
}
