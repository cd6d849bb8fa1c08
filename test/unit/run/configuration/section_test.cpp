#include "stochastic_platoon/run/configuration/section.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "unit/run/configuration/model_text.hpp"

namespace platoon {
namespace {

using Problems = std::vector<std::string>;

// The problems of a document when `read` reads it.
Problems problems_with(const std::string& yaml, const std::function<void(Section&)>& read) {
  Problems problems;
  Section section(YAML::Load(yaml), "", problems);
  read(section);
  return problems;
}

TEST(Section, ReadsWhatIsThere) {
  const Problems problems = problems_with(
      "{n: 2.5, i: -3, b: true, t: hello, e: '', c: red, v: [1, 2.5], m: [[1, 2], [3, 4], [5, 6]], s: {x: "
      "7}, "
      "l: [{x: 8}, {x: 9}], z: []}",
      [](Section& section) {
        EXPECT_EQ(section.number("n", kPositive), 2.5);
        EXPECT_EQ(section.integer("i", -5, 5), -3);
        EXPECT_TRUE(section.boolean("b"));
        EXPECT_EQ(section.text("t"), "hello");
        EXPECT_EQ(section.text("e"), "");
        EXPECT_EQ(section.choice("c", {"green", "red"}), "red");
        EXPECT_EQ(section.numbers("v"), Eigen::Vector2d(1.0, 2.5));
        Eigen::MatrixXd expected(3, 2);
        expected << 1, 2, 3, 4, 5, 6;
        EXPECT_EQ(section.matrix("m"), expected);
        EXPECT_EQ(section.section("s").number("x", kAnyFinite), 7.0);
        std::vector<Section> list = section.sections("l");
        ASSERT_EQ(list.size(), 2u);
        EXPECT_EQ(list[1].number("x", kAnyFinite), 9.0);
        EXPECT_TRUE(section.sections("z").empty());
        section.reject_unknown_keys();
      });
  EXPECT_EQ(problems, Problems{});
}

TEST(Section, ReadsNumbersInEveryNotation) {
  for (const char* text : {"2.5", "'2.5'", "\" 2.5 \"", "25e-1", "+2.5", "2.50"}) {
    const Problems problems = problems_with(std::string("x: ") + text,
                                            [](Section& section) { EXPECT_EQ(section.number("x", kAnyFinite), 2.5); });
    EXPECT_EQ(problems, Problems{}) << text;
  }
  for (const char* text : {"12", "'12'", "+12", "012"}) {
    const Problems problems =
        problems_with(std::string("x: ") + text, [](Section& section) { EXPECT_EQ(section.integer("x", 0, 100), 12); });
    EXPECT_EQ(problems, Problems{}) << text;
  }
}

TEST(Section, RejectsWhatIsNoFiniteNumber) {
  for (const char* text : {"nan", ".nan", "inf", ".inf", "-.inf", "1e400", "abc", "1,5", "1.5 m", "2.5.1", "0x10",
                           "true", "[1.0]", "{a: 1}"}) {
    const Problems problems =
        problems_with(std::string("x: ") + text, [](Section& section) { section.number("x", kAnyFinite); });
    EXPECT_EQ(problems, Problems{std::string("x: ") + text + ": must be a finite number"});
  }
  EXPECT_EQ(problems_with("x: ''", [](Section& section) { section.number("x", kAnyFinite); }),
            Problems{"x: (empty): must be a finite number"});
}

TEST(Section, RejectsNumbersOutOfRange) {
  const auto number = [](const Allowed& allowed) {
    return [&allowed](Section& section) { section.number("x", allowed); };
  };
  EXPECT_EQ(problems_with("x: 0", number(kPositive)), Problems{"x: 0: must be a finite number > 0"});
  EXPECT_EQ(problems_with("x: -1e-300", number(kPositive)), Problems{"x: -1e-300: must be a finite number > 0"});
  EXPECT_EQ(problems_with("x: 1e-300", number(kPositive)), Problems{});
  EXPECT_EQ(problems_with("x: -0.1", number(kNotNegative)), Problems{"x: -0.1: must be a finite number >= 0"});
  EXPECT_EQ(problems_with("x: 0", number(kNotNegative)), Problems{});
  EXPECT_EQ(problems_with("x: -1e100", number(kAnyFinite)), Problems{});
  EXPECT_EQ(problems_with("x: -2e100", number(kAnyFinite)), Problems{"x: -2e100: must be at most 1e+100 in magnitude"});
}

TEST(Section, RejectsWhatIsNoWholeNumberInRange) {
  for (const char* text : {"0", "11", "-3", "2.0", "2.5", "1e2", "1e-1", "1.25e1", "1e400", "1e1x", "abc",
                           "99999999999999999999", "[1]", "2 3"}) {
    const Problems problems =
        problems_with(std::string("x: ") + text, [](Section& section) { section.integer("x", 1, 10); });
    EXPECT_EQ(problems, Problems{std::string("x: ") + text + ": must be a whole number from 1 to 10"});
  }
  for (const char* text : {"1", "10"}) {
    EXPECT_EQ(problems_with(std::string("x: ") + text, [](Section& section) { section.integer("x", 1, 10); }),
              Problems{});
  }
}

TEST(Section, RejectsWhatIsNeitherTrueNorFalse) {
  const auto read = [](Section& section) { section.boolean("x"); };
  for (const char* text : {"true", "false", "True", "False", "'true'"}) {
    EXPECT_EQ(problems_with(std::string("x: ") + text, read), Problems{}) << text;
  }
  for (const char* text : {"yes", "1", "tru", "[true]"}) {
    EXPECT_EQ(problems_with(std::string("x: ") + text, read),
              Problems{std::string("x: ") + text + ": must be true or false"});
  }
}

TEST(Section, RejectsATextThatIsNoneAndAChoiceThatIsNotOffered) {
  EXPECT_EQ(problems_with("x: [1, 2]", [](Section& section) { section.text("x"); }),
            Problems{"x: [1, 2]: must be a text"});
  EXPECT_EQ(problems_with("x: blue",
                          [](Section& section) {
                            section.choice("x", {"red", "green"});
                          }),
            Problems{"x: blue: must be red or green"});
}

// JSON cannot represent them.
TEST(Section, RejectsTextsAndNamesThatAreNotUtf8) {
  EXPECT_EQ(problems_with("x: M\xfcnchen", [](Section& section) { section.text("x"); }),
            Problems{"x: M\\xfcnchen: must be UTF-8"});
  EXPECT_EQ(problems_with("x: [car, \xce]", [](Section& section) { EXPECT_TRUE(section.texts("x").empty()); }),
            Problems{"x: [car, \\xce]: must be UTF-8"});
  EXPECT_EQ(problems_with("\xce: 1", [](Section& section) { EXPECT_TRUE(section.keys().empty()); }),
            Problems{"\\xce: must be UTF-8"});
  EXPECT_EQ(
      problems_with("x: M\xc3\xbcnchen", [](Section& section) { EXPECT_EQ(section.text("x"), "M\xc3\xbcnchen"); }),
      Problems{});
}

TEST(Section, RejectsListsAndMatricesThatAreNone) {
  for (const char* text : {"[]", "3", "[1, x]", "[1, .nan]", "[[1]]", "{a: 1}"}) {
    EXPECT_EQ(problems_with(std::string("x: ") + text, [](Section& section) { section.numbers("x"); }),
              Problems{std::string("x: ") + text + ": must be a list of finite numbers"});
  }
  for (const char* text : {"[]", "3", "[1, 2]", "[[1, 2], [3]]", "[[1], [x]]", "[[1], []]"}) {
    EXPECT_EQ(problems_with(std::string("x: ") + text, [](Section& section) { section.matrix("x"); }),
              Problems{std::string("x: ") + text + ": must be a list of rows of finite numbers, all of one length"});
  }
}

TEST(Section, RejectsSectionsThatAreNone) {
  EXPECT_EQ(problems_with("x: 3", [](Section& section) { section.section("x"); }),
            Problems{"x: 3: must be a mapping of keys"});
  EXPECT_EQ(problems_with("x: 3", [](Section& section) { section.sections("x"); }),
            Problems{"x: 3: must be a list of mappings"});
  EXPECT_EQ(problems_with("x: [{a: 1}, 3]", [](Section& section) { section.sections("x"); }),
            Problems{"x[1]: 3: must be a mapping of keys"});
}

// An empty entry must not give default values.
TEST(Section, RejectsAnEntryOfNothingInAList) {
  const Problems problems = problems_with("x: [~, {a: 1}]", [](Section& section) {
    for (Section& entry : section.sections("x")) entry.number("a", kAnyFinite);
  });
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].find("x[0]"), 0u);
}

TEST(Section, ReportsEveryKeyThatIsMissing) {
  const Problems problems = problems_with("{present: 1, nothing: }", [](Section& section) {
    section.number("n", kPositive);
    section.integer("i", 0, 7);
    section.boolean("b");
    section.text("t");
    section.choice("c", {"red", "green"});
    section.numbers("v");
    section.matrix("m");
    section.section("s").number("inner", kPositive);
    section.sections("l");
    section.number("nothing", kAnyFinite);
  });
  EXPECT_EQ(problems,
            (Problems{"n: missing: must be a finite number > 0", "i: missing: must be a whole number from 0 to 7",
                      "b: missing: must be true or false", "t: missing: must be a text",
                      "c: missing: must be red or green", "v: missing: must be a list of finite numbers",
                      "m: missing: must be a list of rows of finite numbers, all of one length",
                      "s: missing: must be a mapping of keys", "l: missing: must be a list of mappings",
                      "nothing: missing: must be a finite number"}));
}

TEST(Section, NamesTheWholePathOfAKey) {
  const Problems problems = problems_with("{outer: {list: [{}, {x: a}]}}", [](Section& section) {
    Section outer = section.section("outer");
    std::vector<Section> list = outer.sections("list");
    list[0].number("x", kAnyFinite);
    list[1].number("x", kAnyFinite);
  });
  EXPECT_EQ(problems, (Problems{"outer/list[0]/x: missing: must be a finite number",
                                "outer/list[1]/x: a: must be a finite number"}));
}

TEST(Section, RejectsTheKeysThatNobodyAskedFor) {
  const Problems problems = problems_with("{a: 1, b: 2, c: 3, [d]: 4}", [](Section& section) {
    section.number("a", kAnyFinite);
    EXPECT_TRUE(section.has("b"));
    EXPECT_FALSE(section.has("absent"));
    section.reject_unknown_keys();
  });
  EXPECT_EQ(problems,
            (Problems{"c: unknown key: allowed are a, absent, b", "[d]: unknown key: allowed are a, absent, b"}));
}

TEST(Section, OfADocumentThatIsNoMappingSaysSo) {
  EXPECT_EQ(problems_with("hello", [](Section&) {}), Problems{"the document: hello: must be a mapping of keys"});
  EXPECT_EQ(problems_with("", [](Section&) {}), Problems{"the document: (nothing): must be a mapping of keys"});
  EXPECT_EQ(problems_with("[1, 2]", [](Section& section) { section.number("x", kAnyFinite); }),
            Problems{"the document: [1, 2]: must be a mapping of keys"});
}

TEST(Section, RejectsAKeyThatStandsTwice) {
  std::vector<std::string> problems;
  Section section(YAML::Load("{a: 1, a: 2}"), "", problems);
  section.number("a", kAnyFinite);
  section.reject_unknown_keys();
  EXPECT_EQ(problems, std::vector<std::string>{"a: given twice: must be given once"});
}

TEST(Section, ReadsAWholeNumberWithAnExponent) {
  const auto expect = [](const char* text, std::int64_t value) {
    problems_with(std::string("x: ") + text, [&](Section& section) {
      EXPECT_EQ(section.integer("x", 0, std::int64_t{1} << 62), value) << text;
      EXPECT_EQ(section.problems(), 0u) << text;
    });
  };
  expect("1e9", 1000000000);
  expect("2.5E3", 2500);
  expect("0e0", 0);
  expect("9007199254740993", 9007199254740993);
}

TEST(NumberOf, ReadsATextThatIsNoPartOfADocument) {
  EXPECT_EQ(number_of("wait", "2.5", kPositive), 2.5);
  EXPECT_EQ(integer_of("threads", "1e3", 1, 1024), 1000);
  EXPECT_EQ(problems_of([] { number_of("wait", "", kPositive); }),
            Problems{"wait: (empty): must be a finite number > 0"});
  EXPECT_EQ(problems_of([] { integer_of("threads", "0", 1, 1024); }),
            Problems{"threads: 0: must be a whole number from 1 to 1024"});
}

}  // namespace
}  // namespace platoon
