// SPDX-License-Identifier: BSD-3-Clause
#include "view/page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace orchard::view {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t number = 0;
  for (auto at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++number;
  return number;
}

TEST(Page, NothingFromOutsideIsMarkup) {
  const std::string html =
      page_html("</title><script>alert(1)</script>",
                R"({"title": "</script><script>alert(2)</script> {{SCRIPT}}"})", PageSource::kFile);
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_EQ(count(html, "</script>"), 2u) << "the data's and the script's own";
  EXPECT_EQ(count(html, "</title>"), 1u);
  EXPECT_THAT(html, HasSubstr("{{SCRIPT}}")) << "data is put in as it is, once";
}

TEST(Page, AsksNobodyForAnything) {
  const std::string html = page_html("map", "{}", PageSource::kFile);
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page_policy(PageSource::kFile), Not(HasSubstr("connect-src")));
  EXPECT_THAT(page_policy(PageSource::kFile), Not(HasSubstr("unsafe")));
  EXPECT_THAT(page_policy(PageSource::kServer), HasSubstr("connect-src 'self'"));
  for (const char* outside :
       {"src=\"http", "href=\"http", "url(", "@import", "onclick=", "onload="}) {
    EXPECT_THAT(html, Not(HasSubstr(outside)));
  }
}

}  // namespace
}  // namespace orchard::view
