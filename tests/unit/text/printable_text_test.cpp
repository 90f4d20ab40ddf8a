// SPDX-License-Identifier: BSD-3-Clause
#include "text/printable_text.hpp"

#include <gtest/gtest.h>

namespace orchard {
namespace {

TEST(PrintableText, LeavesNothingThatSteersATerminal) {
  EXPECT_EQ(printable_text("a\033[31mb\r\n\x7F"), "a?[31mb???");
  EXPECT_EQ(printable_text("a\xC2\x9B"
                           "31m"),
            "a??31m")
      << "CSI as UTF-8";
  EXPECT_EQ(printable_text("a\x9B"
                           "31m"),
            "a?31m")
      << "CSI as one byte";
}

TEST(PrintableText, LeavesWordsAsTheyAre) {
  EXPECT_EQ(printable_text("Apfelb\xC3\xA4ume \xE6\x9E\x97"), "Apfelb\xC3\xA4ume \xE6\x9E\x97");
}

}  // namespace
}  // namespace orchard
