#include "stochastic_platoon/run/configuration/recorded_drive.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "unit/messages.hpp"
#include "unit/temporary_folder.hpp"

namespace platoon {
namespace {

class RecordedDriveTest : public testing::Test {
protected:
  RecordedDrive with(const std::string& text) {
    RecordedDrive drive;
    drive.file = folder_ / "drive.csv";
    folder_.file("drive.csv", text);
    return drive;
  }

  std::string problem_with(const std::string& text) {
    const std::string problem = message_of<std::invalid_argument>([&] { positions_of(with(text), 0.5); });
    return problem.substr(problem.find("drive.csv: ") + 11);
  }

  TemporaryFolder folder_;
};

TEST_F(RecordedDriveTest, SpeedsAreInterpolatedAndIntegrated) {
  // Speeds at 0, 0.5, 1, 1.5 s: 0, 1, 2, 3 m/s.
  EXPECT_EQ(positions_of(with("time,speed\n0,0\n1,2\n1.5,3\n"), 0.5), (std::vector<double>{0.0, 0.0, 0.25, 1.0, 2.25}));
}

TEST_F(RecordedDriveTest, ColumnsUnitsRowsAndStartCanBeChosen) {
  RecordedDrive drive =
      with("logged by car 1\nnothing\nTime [s]; Lap; v1\n\n100.0; 7; 36\n100.5; 7; 72\n101.0; 7; 36\r\n");
  drive.time = "Time [s]";
  drive.value = "v1";
  drive.unit = 1.0 / 3.6;
  drive.skip_rows = 2;
  drive.from_second = 0.5;
  EXPECT_EQ(positions_of(drive, 0.5), (std::vector<double>{0.0, 0.0, 0.25 * (20.0 + 10.0)}));
}

TEST_F(RecordedDriveTest, RowsMayEndWithSeparators) {
  EXPECT_EQ(positions_of(with("time,speed,lap,lap\n0,0,1,\n0.5,1,,,,\n"), 0.5), (std::vector<double>{0.0, 0.0, 0.25}));
}

TEST_F(RecordedDriveTest, MarkOfSpreadsheetsBeforeTheFirstNameDoesNotCount) {
  EXPECT_EQ(positions_of(with("\xEF\xBB\xBFtime;speed\r\n0;0\r\n0.5;1\r\n"), 0.5),
            (std::vector<double>{0.0, 0.0, 0.25}));
}

// 16.1 - 15.1 and 1700000002.1 - 1700000001.1 are above 1 in double.
TEST_F(RecordedDriveTest, RowsOfEachSecondAreNoGaps) {
  EXPECT_EQ(positions_of(with("time,speed\n15.1,1\n16.1,1\n17.1,1\n"), 1.0).size(), 4u);
  EXPECT_GE(positions_of(with("time,speed\n1700000001.1,1\n1700000002.1,1\n1700000003.1,1\n"), 0.5).size(), 4u);
}

TEST_F(RecordedDriveTest, PositionsBeginAtTheFirst) {
  RecordedDrive drive = with("time\tx\n0\t10\n1\t12\n");
  drive.value = "x";
  drive.is_speed = false;
  EXPECT_EQ(positions_of(drive, 0.5), (std::vector<double>{0.0, 0.0, 1.0, 2.0}));
}

TEST_F(RecordedDriveTest, EveryFaultNamesItsRow) {
  EXPECT_EQ(problem_with(""), "holds no row of column names");
  EXPECT_EQ(problem_with("time,speed\n"), "holds no rows below the column names");
  EXPECT_EQ(problem_with("#ROSBAG V2.0\n"),
            "a bag: must be a table of numbers; recorded_drive writes the speed of a bag's car as one");
  EXPECT_EQ(problem_with("time,velocity\n0,1\n1,1\n"), "no column speed: must be one of time, velocity");
  EXPECT_EQ(problem_with("time,speed\n0,1\n0.5,nan\n"), "row 3: speed: nan: must be a finite number");
  EXPECT_EQ(problem_with("time,speed\n0,1\n0.5\n"), "row 3: speed: (empty): must be a finite number");
  EXPECT_EQ(problem_with("time,speed\n0,1\n0.5,1x\n"), "row 3: speed: 1x: must be a finite number");
  EXPECT_EQ(problem_with("time,speed\n0,1\n0.5,0x10\n"), "row 3: speed: 0x10: must be a finite number");
  EXPECT_EQ(problem_with("time;speed\n0;1\n0,5;1\n"), "row 3: time: 0,5: must be a finite number with a decimal point");
  EXPECT_EQ(problem_with(std::string("time,speed\n0,1\n0.5,1\0\n", 22)),
            "row 3: speed: 1\\x00: must be a finite number");
  EXPECT_EQ(problem_with("time,speed,speed\n0,1,2\n1,1,2\n"), "row 1: columns 2 and 3 are speed: must be one");
  EXPECT_EQ(problem_with("time,speed\n0,1\n0,5,1\n"), "row 3: 3 cells: must be at most 2, the number of columns");
  EXPECT_EQ(problem_with("time,speed\n0,1\n0.5,1\n0.5,1\n"), "row 4: time: 0.5 after 0.5: must ascend");
  EXPECT_EQ(problem_with("time,speed\n1700000000.25,1\n1700000000.125,1\n"),
            "row 3: time: 1700000000.125 after 1700000000.25: must ascend");
  EXPECT_EQ(problem_with("time,speed\n0,1\n0.5,1e200\n"), "row 3: speed: 1e200: must be at most 1e+09 in magnitude");
  EXPECT_EQ(problem_with("time,speed\n0,1\n1.5,1\n"), "row 3: 1.5 s after the row before: must be at most 1 s");
  EXPECT_EQ(problem_with("time,speed\n0,1\n0.4,1\n"),
            "ends 0.4 s after its first row: must go on beyond from_second = 0 s by a sample period of 0.5 s");
  RecordedDrive missing;
  missing.file = folder_ / "no drive.csv";
  EXPECT_THROW(positions_of(missing, 0.5), std::invalid_argument);
}

}  // namespace
}  // namespace platoon
