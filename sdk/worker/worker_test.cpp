// SPDX-License-Identifier: Apache-2.0
#include "meso/worker/worker.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

namespace meso::worker {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* plate = R"(<meso xmlns="urn:meso-format:1.0" version="1.0" unit="millimeter">
<macrostructures><macrostructure id="m"><csg><box dx="10" dy="20" dz="3"/></csg></macrostructure></macrostructures>
<unitCells><unitCell id="u"><csg><cylinder x1="5" y1="5" z1="-1" x2="5" y2="5" z2="4" radius="2"/></csg></unitCell></unitCells>
<patterns><pattern id="c" unitCell="u"><loop index="j" axis="y" count="2" spacing="10"/></pattern></patterns>
<parts><part id="p" macrostructure="m"><apply pattern="c" operation="difference"/></part></parts></meso>
)";

class Worker : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  fs::path file(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
    return folder / name;
  }
  /// A program that does anything but what it should.
  Options program(const std::string& script) const {
    const fs::path path = file("program", "#!/bin/sh\n" + script + "\n");
    ::chmod(path.c_str(), 0755);
    return {.command = path.string()};
  }
  std::vector<Code> codes() const {
    std::vector<Code> all;
    for (const Diagnostic& d : sink.diagnostics()) all.push_back(d.code);
    return all;
  }

  fs::path folder = fs::path(testing::TempDir()) /
                    ("meso_worker_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  DiagnosticSink sink;
};

TEST_F(Worker, MakesAPart) {
  const fs::path in = file("plate.meso", plate), out = folder / "plate.step";
  std::vector<std::string> stages;
  Options options{.command = MESO_COMMAND};
  options.run.progress = [&](std::string_view stage, double) { stages.emplace_back(stage); };
  const auto made = convert(in, out, {}, options, sink);
  ASSERT_TRUE(made) << (sink.diagnostics().empty() ? "" : message(sink.diagnostics()[0]));
  EXPECT_NEAR(made->volume, 3 * (200 - 8 * 3.14159265358979), 1e-6);
  EXPECT_TRUE(made->closed);
  EXPECT_EQ(made->engine, "brep");
  EXPECT_EQ(made->bytes, fs::file_size(out));
  EXPECT_GT(made->peak_bytes, 0U);
  EXPECT_FALSE(stages.empty());
}

TEST_F(Worker, PassesOnWhereADocumentIsWrong) {
  const fs::path in =
      file("wrong.meso", std::string(plate).replace(std::string(plate).find("count=\"2\""), 9, "count=\"-2\""));
  EXPECT_FALSE(convert(in, folder / "a.step", {}, {.command = MESO_COMMAND}, sink));
  ASSERT_EQ(sink.error_count(), 1U);
  EXPECT_EQ(sink.diagnostics()[0].where.line, 4U);
  EXPECT_EQ(sink.diagnostics()[0].where.file, in.string());
  EXPECT_FALSE(fs::exists(folder / "a.step"));
}

TEST_F(Worker, AnswersAsJson) {
  const auto answer = run({"info", "--estimate", file("plate.meso", plate).string()}, {.command = MESO_COMMAND}, sink);
  ASSERT_TRUE(answer);
  EXPECT_TRUE(nlohmann::json::parse(*answer).is_object());
}

TEST_F(Worker, ACrashIsADiagnostic) {
  EXPECT_FALSE(run({"convert", "a", "b"}, program("kill -SEGV $$"), sink));
  ASSERT_EQ(codes(), std::vector{Code::geometry_crashed});
  EXPECT_EQ(sink.diagnostics()[0].args[0], "Segmentation fault");
}

TEST_F(Worker, NoAnswerIsADiagnostic) {
  EXPECT_FALSE(run({"convert", "a", "b"}, program("echo hello; exit 3"), sink));
  EXPECT_EQ(codes(), std::vector{Code::geometry_crashed});
}

TEST_F(Worker, HangingEndsAtTheDeadline) {
  Options options = program("trap '' TERM; sleep 100; sleep 100");
  const auto begin = Clock::now();
  options.run.deadline = begin + std::chrono::milliseconds(200);
  EXPECT_FALSE(run({"convert", "a", "b"}, options, sink));
  EXPECT_EQ(codes(), std::vector{Code::limit_time});
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(10));
}

TEST_F(Worker, CancelledEndsTheWork) {
  Options options = program("exec sleep 100");
  const auto begin = Clock::now();
  options.run.cancelled = [&] { return Clock::now() - begin > std::chrono::milliseconds(300); };
  EXPECT_FALSE(run({"convert", "a", "b"}, options, sink));
  EXPECT_EQ(codes(), std::vector{Code::cancelled});
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(3));
}

TEST_F(Worker, AMissingProgramIsADiagnostic) {
  EXPECT_FALSE(run({"convert", "a", "b"}, {.command = (folder / "nobody").string()}, sink));
  EXPECT_EQ(codes(), std::vector{Code::worker_not_started});
}

TEST_F(Worker, MuchTextOnBothStreams) {
  const Options options = program(
      "i=0; while [ $i -lt 5000 ]; do echo 'some words of no meaning at all ...' >&2; i=$((i+1)); done\n"
      "echo '{\"diagnostics\": [], \"long\": \"'$(head -c 300000 /dev/zero | tr '\\0' x)'\"}'");
  const auto answer = run({"convert", "a", "b"}, options, sink);
  ASSERT_TRUE(answer);
  EXPECT_GT(answer->size(), 300000U);
}

/// As a host may have it: signals of children ignored, others blocked.
TEST_F(Worker, TheHostsSignalsStayAsTheyAre) {
  struct sigaction ignore {
  }, before{}, after{};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGCHLD, &ignore, &before);
  sigset_t blocked, mask_before, mask_after;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &blocked, &mask_before);
  const auto made = convert(file("plate.meso", plate), folder / "plate.step", {}, {.command = MESO_COMMAND}, sink);
  sigaction(SIGCHLD, &before, &after);
  pthread_sigmask(SIG_SETMASK, &mask_before, &mask_after);
  EXPECT_TRUE(made);
  EXPECT_EQ(after.sa_handler, SIG_IGN);
  EXPECT_EQ(sigismember(&mask_after, SIGTERM), 1);
}

}  // namespace
}  // namespace meso::worker
