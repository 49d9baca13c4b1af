// The folder with a run's keys: what is made, and what is refused.
#include "security/key_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "scratch_store.h"

namespace aurasim::security {
namespace {

namespace fs = std::filesystem;
using std::chrono::days;
using std::chrono::hours;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr days kValid{10};

mode_t mode_of(const fs::path& path) {
  struct stat status = {};
  EXPECT_EQ(::stat(path.c_str(), &status), 0) << path;
  return status.st_mode & 0777;
}

Seconds now() { return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()); }

/// What `work` is refused with; empty: it is not.
template <class Work>
std::string refusal(Work&& work) {
  try {
    work();
  } catch (const BadKeys& error) {
    return error.what();
  }
  return "";
}

class Keys : public ::testing::Test {
 protected:
  Keys() { store().add(member_of_region(2), kValid); }

  KeyStore& store() { return scratch_.store; }
  fs::path file(const std::string& name) { return store().folder() / name; }
  fs::path of_region_2(const std::string& name) { return file("names/region-2/" + name); }
  std::string refusal_of_region_2() {
    return refusal([&] { store().files_of("region-2"); });
  }
  void replace(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

  ScratchStore scratch_;
};

TEST_F(Keys, ThatAreGoodAreTaken) { EXPECT_EQ(refusal_of_region_2(), ""); }

TEST_F(Keys, AreTheirOwnersAlone) {
  for (const auto& entry : fs::recursive_directory_iterator(store().folder())) {
    const std::string name = entry.path().filename();
    if (entry.is_directory()) {
      EXPECT_EQ(mode_of(entry.path()), 0700U) << entry.path();
    } else if (name.find("key.pem") != std::string::npos) {
      EXPECT_EQ(mode_of(entry.path()), 0600U) << entry.path();
    }
  }
}

TEST_F(Keys, ThatOthersMayReadAreRefused) {
  fs::permissions(of_region_2("key.pem"), fs::perms::group_read, fs::perm_options::add);
  EXPECT_THAT(refusal_of_region_2(), AllOf(HasSubstr("key.pem"), HasSubstr("0640"), HasSubstr("chmod 600")));
}

TEST_F(Keys, WithAFileMissingAreRefusedByItsName) {
  for (const std::string name : {"identity_ca.pem", "permissions_ca.pem", "crl.pem", "governance.p7s",
                                 "names/region-2/key.pem", "names/region-2/permissions.p7s"}) {
    const std::string text = text_of(file(name));
    const auto mode = fs::status(file(name)).permissions();
    fs::remove(file(name));
    EXPECT_THAT(refusal_of_region_2(), HasSubstr(file(name).string()));
    replace(file(name), text);
    fs::permissions(file(name), mode);
  }
  EXPECT_EQ(refusal_of_region_2(), "");
}

TEST_F(Keys, WithAFileThatIsEmptyOrSomethingElseAreRefusedWithWhatBelongsThere) {
  for (const auto& [name, what] : std::vector<std::pair<std::string, std::string>>{
           {"identity_ca.pem", "a certificate in PEM format"},
           {"crl.pem", "a list of revocations in PEM format"},
           {"governance.p7s", "a signed document in S/MIME format"},
           {"names/region-2/certificate.pem", "a certificate in PEM format"},
           {"names/region-2/key.pem", "a private key in PEM format"},
           {"names/region-2/permissions.p7s", "a signed document in S/MIME format"}}) {
    const std::string text = text_of(file(name));
    replace(file(name), "");
    EXPECT_EQ(refusal_of_region_2(), file(name).string() + ": found an empty file, allowed: " + what +
                                         "; `aurasim keys` makes it anew (rotate NAME, or init)");
    replace(file(name), "nothing of the kind\n");
    EXPECT_THAT(refusal_of_region_2(), AllOf(StartsWith(file(name).string() + ": found something else (OpenSSL: "),
                                             HasSubstr("allowed: " + what)));
    replace(file(name), text);
  }
  EXPECT_EQ(refusal_of_region_2(), "");
}

TEST_F(Keys, OfNobodyWhoIsThereAreRefusedWithThoseWhoAre) {
  EXPECT_THAT(refusal([&] { store().files_of("region-3"); }),
              AllOf(HasSubstr("region-3"), HasSubstr("there are: region-2")));
}

TEST_F(Keys, ThatHaveEndedAreRefused) {
  store().add({"late", Role::kViewer}, Validity{now() - hours(2), now() - hours(1)});
  EXPECT_THAT(refusal([&] { store().files_of("late"); }), AllOf(HasSubstr("expired"), HasSubstr("clock")));
}

TEST_F(Keys, WhoseTimeHasNotComeAreRefusedWithTheClock) {
  store().add({"early", Role::kViewer}, Validity{now() + hours(1), now() + hours(2)});
  EXPECT_THAT(refusal([&] { store().files_of("early"); }), AllOf(HasSubstr("valid from"), HasSubstr("clock says")));
}

TEST_F(Keys, ThatAreRevokedAreRefused) {
  store().add({"desk", Role::kOperator}, kValid);
  store().revoke("desk");
  EXPECT_THAT(refusal([&] { store().files_of("desk"); }), HasSubstr("revoked"));
  EXPECT_EQ(refusal_of_region_2(), "") << "others are believed";
}

TEST_F(Keys, ThatWereReplacedAreRevokedWithTheNewOnes) {
  const std::string old = text_of(of_region_2("certificate.pem"));
  store().rotate("region-2", kValid);
  EXPECT_NE(text_of(of_region_2("certificate.pem")), old);
  EXPECT_EQ(refusal_of_region_2(), "");
  store().revoke("region-2");
  const auto revoked = read_revocations(text_of(file("crl.pem")), text_of(file("identity_ca.pem")));
  EXPECT_THAT(revoked, Contains(read_certificate(old).serial));
  store().rotate("region-2", kValid);
  EXPECT_EQ(refusal_of_region_2(), "") << "new keys are believed again";
}

TEST_F(Keys, OfAnotherAuthorityAreRefused) {
  ScratchStore other;
  other.store.add(member_of_region(2), kValid);
  for (const char* name : {"certificate.pem", "key.pem"}) {
    fs::copy_file(other.store.folder() / "names/region-2" / name, of_region_2(name),
                  fs::copy_options::overwrite_existing);
  }
  EXPECT_THAT(refusal_of_region_2(), HasSubstr("not signed by"));
}

TEST_F(Keys, ThatDoNotFitTheirCertificateAreRefused) {
  store().add(member_of_region(3), kValid);
  fs::copy_file(file("names/region-3/key.pem"), of_region_2("key.pem"), fs::copy_options::overwrite_existing);
  EXPECT_THAT(refusal_of_region_2(), HasSubstr("is not its private key"));
}

TEST_F(Keys, WithPermissionsThatSomebodyHasChangedAreRefused) {
  std::string text = text_of(of_region_2("permissions.p7s"));
  const std::size_t at = text.find("region/2/to");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, 8, "region/3");
  replace(of_region_2("permissions.p7s"), text);
  EXPECT_THAT(refusal_of_region_2(), AllOf(HasSubstr("permissions.p7s"), HasSubstr("verify")));
}

TEST_F(Keys, OfAnEarlierVersionAreKnownByTheRightsThatTheyLack) {
  EXPECT_TRUE(store().has_all_rights("region-2"));
  const Certificate certificate = read_certificate(text_of(of_region_2("certificate.pem")));
  Grants before = grants_of(Role::kRegion, 2);
  for (Grant& grant : before.subscribes) std::erase(grant.partitions, "from_hub");
  const KeyPair authority{text_of(file("private/permissions_ca.key.pem")), text_of(file("permissions_ca.pem"))};
  replace(of_region_2("permissions.p7s"),
          sign(authority, permissions_document(certificate.subject, certificate.valid, before)));
  EXPECT_EQ(refusal_of_region_2(), "") << "they are good for a run without a hub";
  EXPECT_FALSE(store().has_all_rights("region-2"));
  EXPECT_FALSE(store().check().front().has_all_rights);
  store().rotate("region-2", kValid);
  EXPECT_TRUE(store().has_all_rights("region-2"));
}

TEST_F(Keys, AreNotMadeTwice) {
  EXPECT_THAT(refusal([&] { store().add(member_of_region(2), kValid); }), HasSubstr("rotate"));
  EXPECT_THAT(refusal([&] { KeyStore::create(store().folder(), kValid); }), HasSubstr("exists"));
}

TEST_F(Keys, HaveNamesThatSayNoMoreThanTheirRole) {
  EXPECT_THAT(refusal([&] { store().add({"region-7", Role::kViewer}, kValid); }), HasSubstr("region-N"));
  for (const char* name : {"", "../x", "a b", "-x", "a,O=b", "a/b"}) {
    EXPECT_THAT(refusal([&] { store().add({name, Role::kViewer}, kValid); }), HasSubstr("allowed")) << name;
  }
}

TEST_F(Keys, ForAHostAreWithoutThoseOfTheAuthorities) {
  const auto files = store().files_for_host({"region-2"});
  const fs::path host = scratch_.parent() / "host";
  for (const fs::path& name : files) {
    EXPECT_THAT(name.string(), Not(HasSubstr("private")));
    fs::create_directories((host / name).parent_path());
    fs::copy_file(file(name.string()), host / name);
  }
  KeyStore there(host);
  EXPECT_EQ(refusal([&] { there.files_of("region-2"); }), "");
  EXPECT_THAT(refusal([&] { there.add({"desk", Role::kOperator}, kValid); }), HasSubstr("private/identity_ca.key.pem"));
}

TEST_F(Keys, AreCheckedAllTogether) {
  store().add({"late", Role::kViewer}, Validity{now() - hours(2), now() - hours(1)});
  replace(file("names/region-2/certificate.pem"), "no certificate");
  const auto states = store().check();
  ASSERT_EQ(states.size(), 2U);
  EXPECT_THAT(states[0].problem, HasSubstr("expired"));
  EXPECT_THAT(states[1].problem, HasSubstr("certificate.pem"));
}

TEST(AFolderWithoutKeys, IsRefused) {
  EXPECT_THAT(refusal([] { KeyStore("/tmp"); }), HasSubstr("aurasim keys init"));
}

}  // namespace
}  // namespace aurasim::security
