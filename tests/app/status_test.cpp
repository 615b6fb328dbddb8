// `mica status`: what a folder's pictures and logs say of a sequence.
#include "tests/app/farm_job.h"

namespace mica::host::app::status_test {
namespace {

class Status : public FarmTest {
 protected:
  std::string status(const std::string& more = "") const { return mica("status out " + more).out; }
  /// A log as another machine would have left it, of a process that has frames 0 to 5.
  std::string events_of(const std::string& host, int process, const std::string& events) const {
    const std::string who = "\"host\":\"" + host + "\",\"process\":" + std::to_string(process);
    std::string text =
        R"({"time":"2026-01-01T00:00:00.000Z","event":"started",)" + who +
        R"(,"frames":"0-5","hash":"00","job":"job.toml","mica":"0","output":"out/b.exr","range":[0,5]})" +
        "\n";
    std::istringstream lines(events);
    for (std::string line; std::getline(lines, line);)
      text += R"({"time":"2026-01-01T00:00:01.000Z",)" + who + "," + line + "}\n";
    return text;
  }
};

TEST_F(Status, KnowsWhatIsDoneFailedAndMissing) {
  std::filesystem::create_directories(path("out/a.0002.exr"));
  ASSERT_EQ(mica("render job.toml -o out/a.exr --frames 0-3 --quiet --json-log out/a.jsonl").code, 1);
  std::string text = status();
  EXPECT_NE(text.find("a.exr: 6 frames, 3 done, 0 running, 1 failed, 2 missing\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("frame 2 failed: file: "), std::string::npos) << text;
  EXPECT_NE(text.find("remaining: --frames 2,4-5\n"), std::string::npos) << text;
  EXPECT_EQ(status("--remaining"), "2,4-5\n");

  change("out/a.0001.exr", bytes(path("out/a.0001.exr")).size() - 10);
  EXPECT_EQ(status("--remaining"), "1-2,4-5\n");
  std::filesystem::remove(path("out/a.0002.exr"));
  ASSERT_EQ(mica("render job.toml -o out/a.exr --frames $('" MICA_PROGRAM
                 "' status out --remaining) --skip-finished --quiet --json-log out/b.jsonl")
                .code,
            0);
  EXPECT_EQ(words("out/b.jsonl"), "started finished finished finished finished ended");
  EXPECT_EQ(status("--remaining"), "");
  EXPECT_EQ(mica("status out --html page.html").code, 0);
  const std::string page = bytes(path("page.html"));
  std::size_t pictures = 0;
  for (std::size_t at = 0; (at = page.find("src=\"data:image/png;base64,", at)) != page.npos; ++at)
    ++pictures;
  EXPECT_EQ(pictures, 6u);
  // Frames of another job are none of this one.
  ASSERT_EQ(mica("render job.toml -o out/a.exr --frames 0 --set seed=2 --quiet --json-log out/c.jsonl").code,
            0);
  EXPECT_EQ(status("--remaining"), "1-5\n");
}

TEST_F(Status, TellsTheLivingFromTheDead) {
  std::filesystem::create_directory(path("out"));
  mica("", "hostname > host; true;");
  std::string host = bytes(path("host"));
  host = host.substr(0, host.find('\n')).substr(0, 64);
  const std::string works =
      "\"event\":\"phase\",\"phase\":\"render\",\"frame\":0\n"
      "\"event\":\"progress\",\"rows\":3,\"of\":9,\"frame\":0\n";
  write("out/b.jsonl", events_of(host, getpid(), works));
  std::string text = status();
  EXPECT_NE(text.find("0 done, 6 running, 0 failed, 0 missing"), std::string::npos) << text;
  EXPECT_NE(text.find("frame 0 running: " + host), std::string::npos) << text;
  EXPECT_NE(text.find("3 of 9 rows"), std::string::npos) << text;

  write("out/b.jsonl", events_of(host, 99999999, works));  // above any process number
  text = status();
  EXPECT_NE(text.find("0 done, 0 running, 1 failed, 5 missing"), std::string::npos) << text;
  EXPECT_NE(text.find("frame 0 failed: its process is gone"), std::string::npos) << text;

  write("out/b.jsonl", events_of("elsewhere", 99999999, works));
  EXPECT_NE(status().find("6 running"), std::string::npos) << "its log is fresh";
  const auto now = std::filesystem::file_time_type::clock::now();
  std::filesystem::last_write_time(path("out/b.jsonl"), now - std::chrono::minutes(2));
  EXPECT_NE(status().find("0 running, 1 failed, 5 missing"), std::string::npos);

  // One that died with its last line half written, and one that took over.
  write("out/b.jsonl", events_of("elsewhere", 99999999, works) + "{\"time\":\"2026-01-01T00:0");
  std::filesystem::last_write_time(path("out/b.jsonl"), now - std::chrono::minutes(2));
  write("out/c.jsonl", events_of(host, getpid(), works));
  EXPECT_NE(status().find("6 running"), std::string::npos) << status();
}

TEST_F(Status, RefusesWhatIsNoFolder) {
  EXPECT_EQ(mica("status nowhere").code, 4);
  EXPECT_EQ(mica("status .").code, 0);
  write("nonsense.jsonl", "{}\n[1]\n{\"event\":\"started\",\"time\":1}\nno JSON\n");
  EXPECT_EQ(mica("status .").out, "no frames and no logs\n");
}

}  // namespace
}  // namespace mica::host::app::status_test
