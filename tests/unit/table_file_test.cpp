// Tables that a restarted run continues without a gap or a double row.

#include "impinge/io/table_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <sstream>

#include "shared_directory.hpp"

namespace impinge {
namespace {

class Table : public SharedDirectory {
 protected:
  TableFile table() const { return TableFile(path("table.csv"), "step,pressure"); }
  void write(const std::string& text) const { std::ofstream(path("table.csv")) << text; }
  std::string text() const {
    std::ostringstream all;
    all << std::ifstream(path("table.csv")).rdbuf();
    return all.str();
  }
};

TEST_F(Table, RowsAreReadableAtOnce) {
  TableFile table = this->table();
  table.append("0,1");  // it has not been created yet
  table.create();
  EXPECT_EQ(text(), "step,pressure\n");
  table.append("1,0.5");
  EXPECT_EQ(text(), "step,pressure\n1,0.5\n");
  table.append("2," + std::string(5000, '1'));
  EXPECT_EQ(text().size(), 5023u);
  EXPECT_NO_THROW(table.synchronise());
}

TEST_F(Table, IsContinuedAfterAStep) {
  // Sampled every third step.
  write("step,pressure\n3,a\n6,b\n9,c\n12,d\n");
  TableFile table = this->table();
  EXPECT_EQ(table.resume(10), 3);
  table.append("12,e");
  EXPECT_EQ(text(), "step,pressure\n3,a\n6,b\n9,c\n12,e\n");
}

TEST_F(Table, DropsWhatWasBrokenOff) {
  for (const char* end : {"1", "12", "123,d", "2,double\n", "x\n", "\n"}) {
    write(std::string("step,pressure\n1,a\n2,b\n") + end);
    EXPECT_EQ(table().resume(100), 2) << end;
    EXPECT_EQ(text(), "step,pressure\n1,a\n2,b\n") << end;
  }
  for (const char* whole : {"", "step,pre", "step,pressure"}) {
    write(whole);
    EXPECT_EQ(table().resume(100), 0);
    EXPECT_EQ(text(), "step,pressure\n");
  }
}

TEST_F(Table, AMissingFileHasNoRows) {
  EXPECT_EQ(table().resume(7), 0);
  EXPECT_EQ(text(), "step,pressure\n");
}

TEST_F(Table, OtherColumnsAreNotContinued) {
  const std::string other = "step,force\n1,2\n";
  write(other);
  EXPECT_EQ(failure_of([&] { table().resume(1); }),
            "cannot continue " + path("table.csv") + ": its columns are step,force, not step,pressure");
  EXPECT_EQ(text(), other);
}

TEST_F(Table, APipeIsNotContinued) {
  ASSERT_EQ(mkfifo(path("table.csv").c_str(), 0600), 0);
  EXPECT_EQ(failure_of([&] { table().resume(1); }), "cannot continue " + path("table.csv") + ": it is no regular file");
}

TEST_F(Table, TellsThatItCannotBeWritten) {
  TableFile table(path("nowhere/table.csv"), "step");
  table.create();
  table.append("1");
  const std::string expected = "cannot write " + path("nowhere/table.csv") + ": No such file or directory";
  EXPECT_EQ(failure_of([&] { table.check(); }), expected);
  EXPECT_EQ(failure_of([&] { table.synchronise(); }), expected);
  EXPECT_EQ(failure_of([&] { table.resume(1); }), expected);
}

}  // namespace
}  // namespace impinge
