// Who the server answers, without a server.
#include <gtest/gtest.h>

#include "ui/server.h"

namespace camber::ui {
namespace {

const RequestGuard kGuard{"0a1b", "camber_80", "192.0.2.7", 1000};

Asked asked() { return {{"127.0.0.1:80"}, {}, "0a1b", "", false, {}}; }
int status_of(const Asked& request) {
  const auto refused = refusal(kGuard, request);
  return refused ? refused->status : 200;
}

TEST(RequestGuard, LetsInWhoHasTheTokenInTheAddressOrTheCookie) {
  Asked request = asked();
  EXPECT_EQ(status_of(request), 200);
  request.token.clear();
  EXPECT_EQ(status_of(request), 403);
  request.cookies = "a=b; camber_80=0a1b";
  EXPECT_EQ(status_of(request), 200);
  for (const char* wrong :
       {"camber_81=0a1b", "xcamber_80=0a1b", "camber_80=", "camber_80=0a1", "camber_80", ";;", "="}) {
    request.cookies = wrong;
    EXPECT_EQ(status_of(request), 403) << wrong;
  }
}

TEST(RequestGuard, KnowsItsHostsWithAnyPort) {
  for (const char* own : {"localhost", "LOCALHOST:9", "127.0.0.1:65535", "[::1]", "[::1]:8080", "192.0.2.7:1"})
    EXPECT_TRUE(is_own_host(own, "192.0.2.7")) << own;
  for (const char* other : {"", ":80", "evil.example", "127.0.0.1.evil.example", "localhost.evil.example:80",
                            "127.0.0.1:80@evil.example", "127.0.0.1:", "[::1", "[::1]x", "::1", "192.0.2.8", "0.0.0.0"})
    EXPECT_FALSE(is_own_host(other, "192.0.2.7")) << other;
  EXPECT_TRUE(is_own_host("[fe80::2]:80", "fe80::2"));
}

TEST(RequestGuard, RefusesOtherHostsAndTwoOfThem) {
  Asked request = asked();
  for (const std::vector<std::string>& hosts :
       {std::vector<std::string>{}, {"evil.example"}, {"127.0.0.1", "evil.example"}, {"127.0.0.1", "127.0.0.1"}}) {
    request.hosts = hosts;
    EXPECT_EQ(status_of(request), 403);
  }
}

TEST(RequestGuard, RefusesPagesOfOtherSites) {
  Asked request = asked();
  for (const char* own : {"http://127.0.0.1:80", "http://localhost:5", "http://[::1]:80", "http://192.0.2.7"}) {
    request.origins = {own};
    EXPECT_EQ(status_of(request), 200) << own;
  }
  for (const char* other : {"null", "", "https://127.0.0.1", "http://evil.example", "http://127.0.0.1.evil.example",
                            "file://", "127.0.0.1"}) {
    request.origins = {other};
    EXPECT_EQ(status_of(request), 403) << other;
  }
  request.origins = {"http://127.0.0.1", "http://evil.example"};
  EXPECT_EQ(status_of(request), 403);
}

TEST(RequestGuard, TakesBodiesThatSayTheirLengthUpToTheLimit) {
  Asked request = asked();
  request.has_body = true;
  const auto with = [&](std::vector<std::string> lengths) {
    request.lengths = std::move(lengths);
    return status_of(request);
  };
  EXPECT_EQ(with({}), 411);
  EXPECT_EQ(with({"5", "5"}), 411);
  EXPECT_EQ(with({"1000"}), 200);
  EXPECT_EQ(with({"0"}), 200);
  EXPECT_EQ(with({"1001"}), 413);
  EXPECT_EQ(with({"99999999999999999999999999"}), 413);
  for (const char* text : {"", "-1", "1e2", "0x5", "5 "}) EXPECT_EQ(with({text}), 400) << text;
}

TEST(RequestGuard, MakesLongTokensThatDiffer) {
  const std::string one = new_token();
  EXPECT_EQ(one.size(), 64u);
  EXPECT_EQ(one.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(one, new_token());
}

TEST(RequestGuard, ComparesSecretsAsAWhole) {
  EXPECT_TRUE(same_secret("abc", "abc"));
  EXPECT_FALSE(same_secret("abc", "abd"));
  EXPECT_FALSE(same_secret("abc", "ab"));
  EXPECT_FALSE(same_secret("", ""));
}

}  // namespace
}  // namespace camber::ui
