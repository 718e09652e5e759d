#include "tools/hearsay/program.hpp"

int main(int argc, char** argv) { return hearsay::run_program(argc, argv); }
