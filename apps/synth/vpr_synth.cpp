// vpr-synth: renders sequences of a building, with their ground truth.
#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "common/command.h"
#include "synth/recording.h"

int main(int argc, char** argv) {
  vpr::Program program("vpr-synth", "Render sequences of a building, with their ground truth.",
                       "  vpr-synth building.json -o building");
  std::string world_path;
  program.add_config(program.command());
  program.command().add_option("WORLD", world_path, "world description (JSON)").required();
  program.set_run([&](vpr::Session& session) {
    if (session.options.output.empty())
      throw vpr::Error(vpr::ErrorKind::usage, "the output is missing, as in -o building");
    vpr::World world = vpr::read_world(world_path);
    if (session.command.is_given("--seed") ||
        std::ranges::count(session.options.config_keys, "seed") > 0)
      world.seed = session.options.process.seed;
    const vpr::Output& folder =
        session.outputs.folder(session.options.output, vpr::is_recording_folder);
    const vpr::RecordingSize size =
        vpr::write_recording(world, folder.temporary(), session.monitor);
    session.print_result(
        fmt::format("{}: {}, {}, {} of {}\n", session.options.output,
                    vpr::counted(world.walks.size(), "walk"), vpr::counted(size.frames, "frame"),
                    vpr::counted(size.views, "view"), vpr::counted(world.places.size(), "place")),
        vpr::recording_json(world, size));
  });
  return program.main(argc, argv);
}
