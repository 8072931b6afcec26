#include "cli/command_line.h"

int main(int argc, char** argv) { return camber::cli::run(argc, argv); }
