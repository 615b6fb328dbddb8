// A picture in memory: a job is planned and rendered to named channels of floats, with progress.
#include <cstdio>
#include <numeric>
#include <string>

#include "mica/mica.h"

int main(int argc, char** argv) {
  const std::string text = R"(
    image = { width = 160, height = 90, subpixels = 2, aovs = ["ndf"] }
    camera = { position = [0, -3.2, 1.4], look_at = [0, 0, 0.45], fov = 24 }
    surface.bumps = { generate = "spectrum", resolution = 256, rms_slope = 0.3, correlation = 8, seed = 1 }
    material.gold = { surface = "bumps", repeat = [6, 6], specular = { color = [1, 0.8, 0.4] } }
    shape = [{ type = "shell", material = "gold" }]
    light = [{ type = "point", position = [1.6, -3.6, 3.4], intensity = [25, 25, 25] }]
  )";
  try {
    const mica::Job job = mica::Job::parse(text);
    std::printf("%s", job.plan().c_str());

    mica::RunControl control;  // its token stops the work from another thread: control.cancellation.cancel()
    control.progress = [](std::size_t rows, std::size_t all) { std::printf("%zu of %zu rows\n", rows, all); };
    const mica::Image image = mica::Renderer(mica::Device(), job).render(control);

    const std::vector<float> red = image.channel("R");
    std::printf("%d x %d pixels, %zu channels, mean red %.4g\n", image.width, image.height,
                image.channels.size(),
                std::accumulate(red.begin(), red.end(), 0.0) / static_cast<double>(red.size()));
    if (argc > 1) mica::write(image, argv[1]);  // FILE.exr or FILE.png
    return 0;
  } catch (const mica::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
