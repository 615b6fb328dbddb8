#include "host/app/run_program.h"

int main(int argc, char** argv) {
  return mica::host::app::run_program(argc, argv);
}
