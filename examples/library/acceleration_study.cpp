// How much time would a faster machine save? Usage: acceleration_study P.nc MACHINE.toml
#include <camber/camber.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 3) return std::puts("usage: acceleration_study P.nc MACHINE.toml"), 2;
  try {
    const camber::Program program = camber::read_program(argv[1]);
    camber::Machine machine = camber::read_machine(argv[2]);
    std::puts("mm/s2   total s   cutting s   actual feed mm/min");
    for (const double acceleration : {500.0, 1000.0, 2000.0, 4000.0, 8000.0}) {
      machine.set("axis.all.acceleration_mm_per_s2", acceleration);
      const camber::TimeUse use = camber::time(program, machine).all;
      std::printf("%5.0f %9.2f %11.2f %20.0f\n", acceleration, use.total_s, use.cutting_s, use.average_feed_mm_per_min);
    }
  } catch (const camber::InputError& problem) {
    return std::fprintf(stderr, "%s\n", problem.what()), 1;
  }
}
