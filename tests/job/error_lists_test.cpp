#include "tests/job/job_text.h"

namespace mica::host::test::error_lists_test {
namespace {

std::string message_of(const JobFolder& folder, const std::string& text) {
  try {
    folder.load(text);
    return "";
  } catch (const UsageError& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
}

TEST(ErrorLists, ReportEverythingInTheOrderOfTheFile) {
  const JobFolder folder;
  const std::string path = folder.path("job.toml");
  EXPECT_EQ(
      message_of(folder,
                 "[image]\n"
                 "width = 0\n"
                 "height = \"tall\"\n"
                 "colour = 1\n"
                 "[[shape]]\n"
                 "type = \"sphere\"\n"
                 "material = \"gold\"\n"
                 "[[light]]\n"
                 "type = \"point\"\n"
                 "position = [0, nan, true]\n"),
      path + ":2:9: image.width: found 0; expected an integer in [1, 16384]\n" +  //
          path + ":3:10: image.height: found \"tall\" (a string); expected an integer in [1, 16384]\n" +
          path +
          ":4:1: image.colour: found an unknown key; expected one of: width, height, subpixels, filter, "
          "filter_width, samples, "
          "max_bounces, aovs, exposure, tone_map\n" +
          path +
          ":7:12: shape.0.material: found \"gold\"; expected a table [material.NAME] of that name, and "
          "there is none\n" +
          path +
          ":10:16: light.0.position.1: found nan (a float); expected a number in [-100000000, 100000000]\n" +
          path + ":10:21: light.0.position.2: found true; expected a number in [-100000000, 100000000]");
}

TEST(ErrorLists, FileComesBeforeOverrides) {
  const JobFolder folder;
  const auto issues = folder.issues(kLeastJob + "[audit]\nsamples = -1\n", {"image.width=0", "nonsense"});
  ASSERT_EQ(issues.size(), 3u);
  EXPECT_EQ(issues[0].file, folder.path("job.toml"));
  EXPECT_EQ(issues[0].line, 16);
  EXPECT_EQ(issues[1].file, "--set nonsense");
  EXPECT_EQ(issues[2].file, "--set image.width=0");
}

TEST(ErrorLists, EmptyJobNamesWhatItLacks) {
  const JobFolder folder;
  const std::string path = folder.path("job.toml");
  EXPECT_EQ(message_of(folder, ""), path + ":1:1: found no [[shape]]; expected at least one\n" + path +
                                        ":1:1: found no [[light]]; expected at least one");
}

TEST(ErrorLists, ColumnsCountCodePoints) {
  const JobFolder folder;
  const auto issues = folder.issues("image = { \"größe\" = 1, width = 0 }\n" + kLeastJob);
  ASSERT_EQ(issues.size(), 2u);
  EXPECT_EQ(issues[0].column, 11);
  EXPECT_EQ(issues[1].column, 32);
}

TEST(ErrorLists, ControlCharactersDoNotReachTheTerminal) {
  const JobFolder folder;
  const auto issues = folder.issues(replaced(kLeastJob, "\"gold\"", "\"\\u001b[31m\""));
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].message.find('\x1b'), std::string::npos);
  EXPECT_NE(issues[0].message.find("\\x1b[31m"), std::string::npos) << issues[0].message;
}

TEST(ErrorLists, LongTextIsCutBetweenCharacters) {
  const JobFolder folder;
  std::string name = "x";
  for (int i = 0; i < 500; ++i) name += "é";
  const auto issues = folder.issues(replaced(kLeastJob, "\"gold\"", '"' + name + '"'));
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_NE(issues[0].message.find("é...\""), std::string::npos) << issues[0].message;
}

struct SyntaxError {
  std::string text;
  int line, column;
};

class SyntaxErrors : public testing::TestWithParam<SyntaxError> {};

TEST_P(SyntaxErrors, NameTheirPlace) {
  const JobFolder folder;
  const auto issues = folder.issues(GetParam().text);
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].line, GetParam().line) << issues[0].message;
  EXPECT_EQ(issues[0].column, GetParam().column) << issues[0].message;
  EXPECT_FALSE(issues[0].message.empty());
}

INSTANTIATE_TEST_SUITE_P(Toml, SyntaxErrors,
                         testing::Values(SyntaxError{"seed = 1\nseed : 2\n", 2, 6},  // colon for equals
                                         SyntaxError{"seed =\n", 1, 7},              // no value
                                         SyntaxError{"[image]\nwidth = 1280x720\n", 2, 13},
                                         SyntaxError{"[image\nwidth = 3\n", 1, 7},  // header left open
                                         SyntaxError{"\n  ?\n", 2, 3},
                                         SyntaxError{"seed = 1\nseed = 2\n", 2, 8},  // defined twice
                                         SyntaxError{"[image]\n[audit]\n[image]\n", 3, 1}));

TEST(SyntaxErrors, AreReportedBesideThoseOfOverrides) {
  const JobFolder folder;
  EXPECT_EQ(folder.issues("seed =\n", {"nonsense"}).size(), 2u);
}

TEST(Files, MissingMapIsAnIssueOfTheJob) {
  const JobFolder folder;
  const auto issues =
      folder.issues(replaced(kLeastJob, "generate = \"spectrum\"", "file = \"maps/none.exr\""));
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].line, 3);
  EXPECT_EQ(issues[0].column, 8);
  EXPECT_EQ(issues[0].message, "surface.bumps.file: found no file \"" + folder.path("maps/none.exr") +
                                   "\"; expected one, relative to the job's folder");
}

TEST(Files, FolderIsNoMeshOrBackground) {
  const JobFolder folder;
  std::filesystem::create_directories(folder.path("maps"));
  const auto issues = folder.issues(replaced(kLeastJob, "\"sphere\"", "\"mesh\"\nfile = \"maps\"") +
                                    "[background]\ncolor = [0, 0, 0]\nimage = \"maps\"\n");
  ASSERT_EQ(issues.size(), 3u);
  EXPECT_EQ(issues[0].message,
            "shape.0.file: found the folder \"" + folder.path("maps") + "\"; expected a file");
  EXPECT_EQ(issues[1].line, 18);
  EXPECT_EQ(issues[2].message, "background.image: found an image beside a color; expected one of them");
}

TEST(Files, HeightScaleNeedsHeights) {
  const JobFolder folder;
  folder.write("map.png", "x");
  const std::string map = "file = \"map.png\"\nheight_scale = 2\n";
  const auto issues = folder.issues(replaced(kLeastJob, "generate = \"spectrum\"", map));
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].message,
            "surface.bumps.height_scale: found a scale of heights; expected encoding = \"height\" with it");
  const std::string heights = map + "encoding = \"height\"\n";
  EXPECT_TRUE(folder.issues(replaced(kLeastJob, "generate = \"spectrum\"", heights)).empty());
}

TEST(Files, UnreadableJobIsAFileError) {
  const JobFolder folder;
  std::filesystem::create_directories(folder.path("jobs"));
  for (const std::string name : {"none.toml", "jobs", "none/job.toml"}) {
    try {
      load_job(folder.path(name), {});
      ADD_FAILURE() << name;
    } catch (const FileError& error) {
      EXPECT_EQ(error.kind(), ErrorKind::file);
      EXPECT_EQ(std::string(error.what()).rfind(folder.path(name) + ": ", 0), 0u) << error.what();
    }
  }
}

}  // namespace
}  // namespace mica::host::test::error_lists_test
