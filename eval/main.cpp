// SPDX-License-Identifier: Apache-2.0
#include "eval/commands.h"

int main(int argc, char** argv) {
    return vecino::run_program(argc, argv);
}
