// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>

#include "core/scene.h"
#include "eval/commands.h"
#include "eval/failure.h"
#include "eval/matrix_schema.h"

namespace vecino {

void add_schema_command(CLI::App& app, Action& chosen) {
    auto what = std::make_shared<std::string>();
    CLI::App* const command =
        app.add_subcommand("schema", "the JSON Schema of scenes, matrices or failures");
    command->add_option("WHAT", *what, "scene, matrix, failure")
        ->required()
        ->check(CLI::IsMember({"scene", "matrix", "failure"}));
    command->callback([what, &chosen] {
        chosen = [what] {
            const nlohmann::json schema = *what == "scene"    ? scene_schema()
                                          : *what == "matrix" ? matrix_schema()
                                                              : failure_schema();
            std::printf("%s\n", schema.dump(4).c_str());
            return ExitCode::ok;
        };
    });
}

}  // namespace vecino
