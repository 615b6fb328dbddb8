// Bad input: each has its exit code and a message that helps, and leaves no file.
#include <cmath>
#include <limits>

#include "tests/app/command.h"

namespace mica::host::app::refusals_test {
namespace {

constexpr int kUsage = 2, kDevice = 3, kFile = 4;
const std::string kEval = "eval --ndf triangles --roughness 0.01 -o D.npy ";
const std::string kGrid = "eval --ndf grid --microroughness 0.01 -o D.npy ";
const std::string kNdf = "ndf --ndf triangles --roughness 0.01 --size 8 -o ndf.exr ";

struct Refusal {
  std::string name, arguments;
  int code;
  std::string message;  ///< part of what stderr says
};
void PrintTo(const Refusal& refusal, std::ostream* stream) {
  *stream << refusal.arguments;
}

class Refusals : public CommandTest, public testing::WithParamInterface<Refusal> {
 protected:
  Refusals() {
    write_map();
    write_damaged_maps();
    write("good.npy", npy_of(query_rows(20)));
    write("short.npy", npy_of(query_rows(20)).substr(0, 1000));
    write("object.npy", npy_bytes("|O", false, "(20, 7)", std::string(20 * 7 * 8, '\0')));
    Rows rows = query_rows(20);
    rows[3][5] = std::nan("");
    write("nan_row.npy", npy_of(rows));
    rows = query_rows(20);
    rows[1][3] = rows[19][3] = 1;
    write("not_positive.npy", npy_of(rows));
    std::filesystem::create_directories(path("no_drivers"));
  }

  void write_damaged_maps() const {
    const Surface surface = spectrum();
    const std::string exr = bytes(path("map.exr"));
    write("half.exr", exr.substr(0, exr.size() / 2));
    write("empty.exr", "");
    Image image{32, 32, {"R", "G", "B"}, to_signed_rgb(surface), {}};
    write_png(path("map.png"), image, 0);
    const std::string png = bytes(path("map.png"));
    write("half.png", png.substr(0, png.size() / 2));
    std::string no_width = png;
    no_width.replace(16, 4, std::string(4, '\0'));  // the width in the PNG's header
    write("no_width.png", no_width);
    for (std::size_t n = 0; n < image.pixels.size(); n += 7)
      image.pixels[n] = std::numeric_limits<float>::quiet_NaN();
    write_exr(path("nan.exr"), image);
  }
};

TEST_P(Refusals, HelpAndLeaveNoFile) {
  const std::set<std::string> before = files();
  const Outcome outcome =
      mica(GetParam().arguments, GetParam().code == kDevice ? "OCL_ICD_VENDORS=no_drivers" : "");
  EXPECT_EQ(outcome.code, GetParam().code) << outcome.err;
  EXPECT_NE(outcome.err.find(GetParam().message), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(files(), before);
}

std::string name_of(const testing::TestParamInfo<Refusal>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(
    Maps, Refusals,
    testing::Values(Refusal{"Missing", kEval + "--queries good.npy --map none.exr", kFile, "none.exr"},
                    Refusal{"Folder", kEval + "--queries good.npy --map no_drivers", kFile, "no_drivers"},
                    Refusal{"HalfAnExr", kEval + "--queries good.npy --map half.exr", kFile, "half.exr"},
                    Refusal{"HalfAPng", kEval + "--queries good.npy --map half.png", kFile, "half.png"},
                    Refusal{"NoBytes", kEval + "--queries good.npy --map empty.exr", kFile, "empty.exr"},
                    Refusal{"NoWidth", kEval + "--queries good.npy --map no_width.png", kFile,
                            "no_width.png"},
                    Refusal{"NaN", kEval + "--queries good.npy --map nan.exr", kFile, "nan.exr"},
                    Refusal{"NaNOfNdf", kNdf + "--map nan.exr --center 0,0 --sigma 1", kFile, "nan.exr"}),
    name_of);

// All the rest that can be wrong with a table is in query_table_test.cpp.
INSTANTIATE_TEST_SUITE_P(
    Tables, Refusals,
    testing::Values(
        Refusal{"Missing", kEval + "--map map.exr --queries none.npy", kFile, "none.npy: no such file"},
        Refusal{"Short", kEval + "--map map.exr --queries short.npy", kFile, "short.npy: damaged"},
        Refusal{"Objects", kEval + "--map map.exr --queries object.npy", kUsage, "float32 or float64"},
        Refusal{"NaN", kEval + "--map map.exr --queries nan_row.npy", kUsage,
                "row 3: half vector is not finite"},
        Refusal{"NotPositiveDefinite", kEval + "--map map.exr --queries not_positive.npy", kUsage,
                "2 of 20 rows cannot be evaluated (rows count from 0):\n"
                "  row 1: covariance is not positive definite\n"
                "  row 19: covariance is not positive definite"},
        Refusal{"NoRoughness", "eval --ndf triangles --roughness 0 --map map.exr --queries good.npy -o D.npy",
                kUsage, "20 of 20 rows"},
        Refusal{"OfTheReference",
                "eval --ndf reference --roughness 0.01 --map map.exr --queries nan_row.npy -o D.npy", kUsage,
                "row 3"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    Options, Refusals,
    testing::Values(
        Refusal{"NothingAsked", "", kUsage, "subcommand"},
        Refusal{"UnknownOption", kEval + "--map map.exr --queries good.npy --colour red", kUsage, "--colour"},
        Refusal{"UnknownNdf", "eval --ndf circles --map map.exr --queries good.npy -o D.npy", kUsage,
                "triangles"},
        Refusal{"UnknownQuantity", kEval + "--quantity albedo --map map.exr --queries good.npy", kUsage,
                "ndf"},
        Refusal{"UnknownEncoding", kEval + "--encoding guess --map map.exr --queries good.npy", kUsage,
                "unorm"},
        Refusal{"RoughnessMissing", "eval --ndf triangles --map map.exr --queries good.npy -o D.npy", kUsage,
                "--roughness is needed"},
        Refusal{"MapMissing", kEval + "--queries good.npy", kUsage, "--ndf triangles needs a --map"},
        Refusal{"GridRoughness", kGrid + "--alpha 2 --queries good.npy", kUsage,
                "alpha: found 2; expected a number from 0.0001 to 1"},
        Refusal{"GridDistribution", kGrid + "--distribution round --queries good.npy", kUsage,
                "--distribution"},
        Refusal{"GridDensity", kGrid + "--density 0 --queries good.npy", kUsage,
                "density: found 0; expected a number from 1 to"},
        Refusal{"GridMicroroughness", "eval --ndf grid --queries good.npy -o D.npy", kUsage,
                "--microroughness"},
        Refusal{"GridNaN", kGrid + "--queries nan_row.npy", kUsage, "row 3"},
        Refusal{"Tolerance", kEval + "--tolerance 1e-6 --map map.exr --queries good.npy", kUsage,
                "--ndf reference"},
        Refusal{"OutputName",
                "eval --ndf triangles --roughness 0.1 --map map.exr --queries good.npy -o D.txt", kUsage,
                "ends in .npy"},
        Refusal{"OutputFolder",
                "eval --ndf triangles --roughness 0.1 --map map.exr --queries good.npy -o map.exr/D.npy",
                kFile, "map.exr/D.npy"},
        Refusal{"OutputFolderThatTakesNoFiles",
                "eval --ndf triangles --roughness 0.1 --map map.exr --queries good.npy -o /proc/D.npy", kFile,
                "/proc/D.npy"},
        Refusal{"JsonFolder", kEval + "--map map.exr --queries good.npy --json map.exr/D.json", kFile,
                "D.json"},
        Refusal{"TwoSigmas", kNdf + "--map map.exr --center 0,0 --sigma 2,1", kUsage,
                "TEXELS,TEXELS,DEGREES"},
        Refusal{"NoSigma", kNdf + "--map map.exr --center 0,0 --sigma 0", kUsage, "not positive definite"},
        Refusal{"NoWindow", kNdf + "--map map.exr --center 0,0 --sigma 1 --window 0,0,0", kUsage,
                "positive radius"},
        Refusal{"OneCoordinate", kNdf + "--map map.exr --center 0.5 --sigma 1", kUsage, "--center"},
        Refusal{"NdfName",
                "ndf --ndf triangles --roughness 0.1 --map map.exr --center 0,0 --sigma 1 -o n.jpg", kUsage,
                ".exr or .png"},
        Refusal{"NdfFolder",
                "ndf --ndf triangles --roughness 0.1 --map map.exr --center 0,0 --sigma 1 -o map.exr/n.png",
                kFile, "map.exr/n.png"},
        Refusal{"MapOfNoKind", "map -o new.exr", kUsage, "subcommand"},
        Refusal{"MapTooSmall", "map spectrum --resolution 1 -o new.exr", kUsage, "resolution"},
        Refusal{"MapName", "map flakes --resolution 64 -o new.png", kUsage, ".exr"},
        Refusal{"MapFolder", "map flakes --resolution 64 -o map.exr/new.exr", kFile, "map.exr/new.exr"}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    NoDevice, Refusals,
    testing::Values(Refusal{"Eval", kEval + "--map map.exr --queries good.npy --json D.json", kDevice,
                            "no OpenCL device found"},
                    Refusal{"Ndf", kNdf + "--map map.exr --center 0,0 --sigma 1", kDevice,
                            "no OpenCL device found"},
                    Refusal{"Devices", "devices --json devices.json", kDevice, "apt install pocl-opencl-icd"},
                    Refusal{"Selftest", "selftest --json selftest.json", kDevice, "no OpenCL device found"}),
    name_of);

}  // namespace
}  // namespace mica::host::app::refusals_test
