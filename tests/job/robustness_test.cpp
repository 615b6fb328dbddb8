#include "host/job/read_job.h"
#include "host/job/toml_document.h"
#include "tests/job/job_text.h"

namespace mica::host::test::robustness_test {
namespace {

std::string repeated(const std::string& text, int count) {
  std::string result;
  for (int i = 0; i < count; ++i) result += text;
  return result;
}

std::string read_shell_job() {
  std::ifstream file(MICA_SOURCE_DIR "/data/jobs/shell.toml");
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Reads `text`, which may be wrong but must be called so, with a place in it.
void expect_job_or_issues(const std::string& text) {
  const auto lines = 1 + std::count(text.begin(), text.end(), '\n');
  try {
    read_job(text, "job.toml", {});
  } catch (const JobError& error) {
    ASSERT_FALSE(error.issues().empty());
    for (const JobIssue& issue : error.issues()) {
      ASSERT_GE(issue.line, 1) << issue.message;
      ASSERT_LE(issue.line, lines) << issue.message;
      ASSERT_GE(issue.column, 1) << issue.message;
    }
  }
}

TEST(Robustness, EveryTruncation) {
  const std::string job = read_shell_job();
  ASSERT_GT(job.size(), 500u);
  for (std::size_t length = 0; length <= job.size(); ++length) expect_job_or_issues(job.substr(0, length));
}

TEST(Robustness, EveryByteReplacedRemovedAndDoubled) {
  const std::string job = read_shell_job();
  const std::string replacements = std::string("[]{}=.,\"'#\n\\-9ae \x80\xff\x01", 20) + '\0';
  for (std::size_t i = 0; i < job.size(); ++i) {
    std::string mutated = job;
    mutated[i] = replacements[i % replacements.size()];
    expect_job_or_issues(mutated);
    expect_job_or_issues(job.substr(0, i) + job.substr(i + 1));
    expect_job_or_issues(job.substr(0, i + 1) + job.substr(i));
  }
}

TEST(Robustness, EveryLineMovedToTheFront) {
  const std::string job = read_shell_job();
  for (std::size_t begin = 0; begin < job.size(); begin = job.find('\n', begin) + 1) {
    const std::size_t length = job.find('\n', begin) + 1 - begin;
    std::string moved = job;
    moved.erase(begin, length);
    expect_job_or_issues(job.substr(begin, length) + moved);
  }
}

/// Text that nests without end, around a part that is repeated.
struct Nest {
  const char *begin, *repeat, *end;
};

const std::vector<Nest> kNests = {
    {"[a", ".a", "]"},   {"[[a", ".a", "]]"},     {"[a", " . a", "]"},
    {"a", ".a", " = 1"}, {"a", ".\"a\"", " = 1"}, {"x = { a", ".a", " = 1 }"},
    {"x = ", "[", ""},   {"x = ", "{a=", ""},     {"x = '''\"''' # \" ''' [\ny = ", "[", ""},
};

TEST(DeepNesting, IsAnIssue) {
  const JobFolder folder;
  for (const Nest& nest : kNests) {
    const auto issues = folder.issues(kLeastJob + nest.begin + repeated(nest.repeat, 200000) + nest.end);
    ASSERT_EQ(issues.size(), 1u) << nest.begin;
    EXPECT_EQ(issues[0].message, "found more than 16 nested levels; expected at most 16");
    EXPECT_GE(issues[0].line, 15);
  }
}

TEST(DeepNesting, OverridesToo) {
  const JobFolder folder;
  for (const std::string& text : {"a" + repeated(".a", 200000) + "=1", "x=" + repeated("[", 200000)}) {
    const auto issues = folder.issues(kLeastJob, {text});
    ASSERT_EQ(issues.size(), 1u);
    EXPECT_LT(issues[0].file.size(), 100u);
    EXPECT_EQ(issues[0].message, "found more than 16 nested levels; expected at most 16");
  }
}

TEST(DeepNesting, NamesTheFirstPlaceThatIsTooDeep) {
  const auto place = find_excessive_nesting("é = 1\n'ü' = [[1, [2]]]", 2);
  ASSERT_TRUE(place);
  EXPECT_EQ(place->line, 2u);
  EXPECT_EQ(place->column, 12u);
}

TEST(DeepNesting, IgnoresWhatIsNotNested) {
  const std::vector<std::string> texts = {
      "a.b = 1.5\nc.d = 1.5",
      "x = [1.0, 2.0, 3.0, 4.0]",
      "x = '[[[[' # [[[[ a.a.a.a",
      "x = \"[[\\\"[[\" ",
      "x = ''' [[[[ a.b.c.d '' [[[ ''''' ",
      "x = \"\"\" [[[ \\\"\"\" [[[ \"\"\"\"\" ",
      "x = ''\ny = \"\"\nz = 1",
      "x = [[1], [2], [3]]\n[a.b]\n[[c.d]]",
      "x = ''''''\ny = [[1]]",
  };
  for (const std::string& text : texts) EXPECT_FALSE(find_excessive_nesting(text, 2)) << text;
}

TEST(DeepNesting, LooksBehindStrings) {
  const std::vector<std::string> texts = {
      R"(x = ['open)"
      "\n[[[1]]]",
      R"(x = ["\"", [[1]]])",    // an escaped quote
      R"(x = ["\\", [[1]]])",    // an escaped backslash
      R"(x = ['\', [[1]]])",     // no escapes in literal strings
      R"(x = ['', "", [[1]]])",  // empty
      R"(x = ["""\"""", [[1]]])",
      R"(x = ["""a"""", [[1]]])",  // one and two quotes before the closing three
      R"(x = ["""a""""", [[1]]])",
      R"(x = ['''\''', [[1]]])",
      R"(x = ['''''', [[1]]])",
  };
  for (const std::string& text : texts) EXPECT_TRUE(find_excessive_nesting(text, 2)) << text;
}

TEST(DeepNesting, IsNotFooledByBracketsThatCloseNothing) {
  EXPECT_TRUE(find_excessive_nesting("x = 1 ] ] ]\ny = [[[1]]]", 2));
}

TEST(Size, OneMebibyteAndNotAByteMore) {
  const JobFolder folder;
  const std::string full = kLeastJob + std::string((1 << 20) - kLeastJob.size(), '#');
  EXPECT_TRUE(folder.issues(full).empty());
  const auto issues = folder.issues(full + '#');
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].message, "found more than 1048576 bytes; expected at most 1048576");
}

}  // namespace
}  // namespace mica::host::test::robustness_test
