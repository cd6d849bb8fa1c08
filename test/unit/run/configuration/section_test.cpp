#include "stochastic_platoon/run/configuration/section.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "stochastic_platoon/run/configuration/single_number.hpp"
#include "unit/run/configuration/model_text.hpp"

namespace platoon {
namespace {

using Read = std::function<void(Section&)>;

// The problems of a document when `read` reads it.
Problems problems_with(const std::string& yaml, const Read& read) {
  Problems problems;
  Section section(YAML::Load(yaml), "", problems);
  read(section);
  return problems;
}

// Reads each of these values of the key x without a problem.
void expect_accepted(const std::vector<std::string>& values, const Read& read) {
  for (const std::string& value : values) EXPECT_EQ(problems_with("x: " + value, read), Problems{}) << value;
}

// Reports for each of these values of the key x what is allowed.
void expect_rejected(const std::vector<std::string>& values, const std::string& allowed, const Read& read) {
  for (const std::string& value : values)
    EXPECT_EQ(problems_with("x: " + value, read), Problems{"x: " + value + ": must be " + allowed});
}

void read_number(Section& section) {
  section.number("x", kAnyFinite);
}

TEST(Section, ReadsValuesOfEveryType) {
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
  expect_accepted({"2.5", "'2.5'", "\" 2.5 \"", "25e-1", "+2.5", "2.50"},
                  [](Section& section) { EXPECT_EQ(section.number("x", kAnyFinite), 2.5); });
  expect_accepted({"12", "'12'", "+12", "012"}, [](Section& section) { EXPECT_EQ(section.integer("x", 0, 100), 12); });
}

TEST(Section, RejectsAnInvalidNumber) {
  expect_rejected(
      {"nan", ".nan", "inf", ".inf", "-.inf", "1e400", "abc", "1.5 m", "2.5.1", "0x10", "true", "[1.0]", "{a: 1}"},
      "a finite number", read_number);
  EXPECT_EQ(problems_with("x: ''", read_number), Problems{"x: (empty): must be a finite number"});
}

TEST(Section, RejectsNumbersOutOfRange) {
  const auto number = [](const Allowed& allowed) {
    return [&allowed](Section& section) { section.number("x", allowed); };
  };
  expect_rejected({"0", "-1e-300"}, "a finite number > 0", number(kPositive));
  expect_rejected({"-0.1"}, "a finite number >= 0", number(kNotNegative));
  expect_rejected({"-2e100"}, "at most 1e+100 in magnitude", read_number);
  expect_accepted({"1e-300"}, number(kPositive));
  expect_accepted({"0"}, number(kNotNegative));
  expect_accepted({"-1e100"}, read_number);
}

TEST(Section, RejectsAnInvalidWholeNumber) {
  const auto read = [](Section& section) { section.integer("x", 1, 10); };
  expect_rejected({"0", "11", "-3", "2.0", "2.5", "1e2", "1e-1", "1.25e1", "1e400", "1e1x", "abc",
                   "99999999999999999999", "[1]", "2 3"},
                  "a whole number from 1 to 10", read);
  expect_accepted({"1", "10"}, read);
}

TEST(Section, RejectsAnInvalidBoolean) {
  const auto read = [](Section& section) { section.boolean("x"); };
  expect_accepted({"true", "false", "True", "False", "'true'"}, read);
  expect_rejected({"yes", "1", "tru", "[true]"}, "true or false", read);
}

TEST(Section, RejectsAnInvalidTextOrChoice) {
  expect_rejected({"[1, 2]"}, "a text", [](Section& section) { section.text("x"); });
  expect_rejected({"blue"}, "red or green", [](Section& section) { section.choice("x", {"red", "green"}); });
}

// JSON cannot represent them.
TEST(Section, RejectsTextsAndNamesThatAreNotUtf8) {
  EXPECT_EQ(problems_with("x: M\xfcnchen", [](Section& section) { section.text("x"); }),
            Problems{"x: M\\xfcnchen: must be UTF-8 without a zero byte"});
  EXPECT_EQ(problems_with("x: [car, \xce]", [](Section& section) { EXPECT_TRUE(section.texts("x").empty()); }),
            Problems{"x: [car, \\xce]: must be UTF-8 without a zero byte"});
  EXPECT_EQ(problems_with("\xce: 1", [](Section& section) { EXPECT_TRUE(section.keys().empty()); }),
            Problems{"\\xce: must be UTF-8 without a zero byte"});
  EXPECT_EQ(
      problems_with("x: M\xc3\xbcnchen", [](Section& section) { EXPECT_EQ(section.text("x"), "M\xc3\xbcnchen"); }),
      Problems{});
}

TEST(Section, RejectsAnInvalidListOrMatrix) {
  expect_rejected({"[]", "3", "[1, x]", "[1, .nan]", "[[1]]", "{a: 1}"}, "a list of finite numbers",
                  [](Section& section) { section.numbers("x"); });
  expect_rejected({"[]", "3", "[1, 2]", "[[1, 2], [3]]", "[[1], [x]]", "[[1], []]"},
                  "a list of rows of finite numbers, all of one length", [](Section& section) { section.matrix("x"); });
}

TEST(Section, RejectsAnInvalidSection) {
  const auto read_list = [](Section& section) { section.sections("x"); };
  expect_rejected({"3"}, "a mapping of keys", [](Section& section) { section.section("x"); });
  expect_rejected({"3"}, "a list of mappings", read_list);
  EXPECT_EQ(problems_with("x: [{a: 1}, 3]", read_list), Problems{"x[1]: 3: must be a mapping of keys"});
}

// An empty entry must not give default values.
TEST(Section, RejectsAnEmptyEntryOfAList) {
  const Problems problems = problems_with("x: [~, {a: 1}]", [](Section& section) {
    for (Section& entry : section.sections("x")) entry.number("a", kAnyFinite);
  });
  EXPECT_TRUE(is_problem(problems, "x[0]"));
}

TEST(Section, ReportsEveryMissingKey) {
  const Problems problems = problems_with("{present: 1, nothing: }", [](Section& section) {
    section.number("n", kPositive);
    section.integer("i", 0, 7);
    section.boolean("b");
    section.text("t");
    section.choice("c", {"red", "green"});
    section.numbers("v");
    section.matrix("m");
    section.section("s").number("inner", kPositive);
    section.section("s");  // reported once
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

TEST(Section, RejectsTheKeysThatWereNotRead) {
  const Problems problems = problems_with("{a: 1, b: 2, c: 3, [d]: 4}", [](Section& section) {
    section.number("a", kAnyFinite);
    EXPECT_TRUE(section.has("b"));
    EXPECT_FALSE(section.has("absent"));
    section.reject_unknown_keys();
  });
  EXPECT_EQ(problems,
            (Problems{"c: unknown key: allowed are a, absent, b", "[d]: unknown key: allowed are a, absent, b"}));
}

TEST(Section, RejectsADocumentThatIsNotAMapping) {
  EXPECT_EQ(problems_with("hello", [](Section&) {}), Problems{"the document: hello: must be a mapping of keys"});
  EXPECT_EQ(problems_with("", [](Section&) {}), Problems{"the document: (nothing): must be a mapping of keys"});
  EXPECT_EQ(problems_with("[1, 2]", read_number), Problems{"the document: [1, 2]: must be a mapping of keys"});
}

TEST(Section, RejectsADuplicateKey) {
  EXPECT_EQ(problems_with("{a: 1, a: 2}",
                          [](Section& section) {
                            section.number("a", kAnyFinite);
                            section.reject_unknown_keys();
                          }),
            Problems{"a: given twice: must be given once"});
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

TEST(Section, ExplainsADecimalComma) {
  const auto both = [](Section& section) {
    section.number("kp", kAnyFinite);
    section.number("kd", kAnyFinite);
    section.reject_unknown_keys();
  };
  const std::string point = ", with a decimal point in place of the comma";
  EXPECT_EQ(problems_with("{kp: 0,2, kd: 1,2}", both),
            (Problems{"kp: 0,2: must be one number" + point, "kd: 1,2: must be one number" + point}));
  EXPECT_EQ(problems_with("{kp: '0,2', kd: 1}", both), Problems{"kp: 0,2: must be a finite number" + point});
  EXPECT_EQ(problems_with("{kp: 0, 2: 5, kd: 1}", both), Problems{"2: unknown key: allowed are kd, kp"});
}

TEST(Section, RejectsAZeroByteInAText) {
  EXPECT_EQ(problems_with("x: \"a\\0b\"", [](Section& section) { section.text("x"); }),
            Problems{"x: a\\x00b: must be UTF-8 without a zero byte"});
}

}  // namespace
}  // namespace platoon
