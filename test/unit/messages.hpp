#pragma once

#include <gtest/gtest.h>

#include <string>

namespace platoon {

/// The message of the exception that `action` throws, or an empty string if it throws none.
template <typename Error, typename Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// Whether a text contains another; a failed expectation shows both.
inline testing::AssertionResult contains(const std::string& text, const std::string& part) {
  const bool found = text.find(part) != std::string::npos;
  return testing::AssertionResult(found) << '"' << text << (found ? "\" contains \"" : "\" does not contain \"") << part
                                         << '"';
}

/// Whether a text begins with another; a failed expectation shows both.
inline testing::AssertionResult begins_with(const std::string& text, const std::string& start) {
  const bool found = text.compare(0, start.size(), start) == 0;
  return testing::AssertionResult(found) << '"' << text << (found ? "\" begins with \"" : "\" does not begin with \"")
                                         << start << '"';
}

}  // namespace platoon
