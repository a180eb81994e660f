// vpr-synth: renders a small world with known positions.
#include <filesystem>

#include <fmt/format.h>

#include "command.h"
#include "synth/wall_walk.h"

int main(int argc, char** argv) {
  vpr::Program program("vpr-synth", "Render walks past corridor walls, with their ground truth.",
                       "  vpr-synth configs/worlds/demo.json -o walk");
  std::string world_path;
  vpr::NoSettings none;
  program.add_config(program.app(), none);
  program.app().add_option("WORLD", world_path, "world description (JSON)")->required();
  program.set_run([&](vpr::Session& session) {
    if (session.options.output.empty())
      throw vpr::Error(vpr::ErrorKind::usage, "give the folder to write, as in -o walk");
    vpr::World world = vpr::read_world(world_path);
    if (program.app().count("--seed") > 0) world.seed = session.options.seed;
    vpr::OutputFolder folder(session.options.output, session.options.existing(),
                             vpr::is_world_folder);
    vpr::write_world(world, folder.temporary(), session.monitor);
    folder.commit();
    size_t frames = 0;
    for (const vpr::Walk& walk : world.walks) frames += vpr::walk_positions(world, walk).size();
    session.print_result(
        fmt::format("{}: {} walks, {} frames\n", session.options.output, world.walks.size(),
                    frames),
        {{"schema", "vpr.world-info/1"}, {"walks", world.walks.size()}, {"frames", frames}});
  });
  return program.main(argc, argv);
}
