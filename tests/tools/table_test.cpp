#include "tools/table.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "tests/pipeline/run_support.hpp"

namespace seampath {
namespace table_test {

using testing::ElementsAre;
using testing::HasSubstr;

class TableFile : public testing::Test {
protected:
    Table read(const std::string& text) {
        std::ofstream(file_, std::ios::binary) << text;
        return read_table(file_);
    }

    std::string error(const std::string& text) {
        try {
            read(text);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no error";
    }

    TestFolder folder_;
    std::filesystem::path file_ = folder_.path() / "table.csv";
};

TEST_F(TableFile, ReadsHeaderRowsAndTheirLines) {
    const Table table = read("# made by hand\nx_mm , \"y_mm\"\r\n\n0,1e-3\r\n-2.5, +4\n");
    EXPECT_THAT(table.header, ElementsAre("x_mm", "y_mm"));
    EXPECT_THAT(table.rows, ElementsAre(ElementsAre(0, 1e-3), ElementsAre(-2.5, 4)));
    EXPECT_THAT(table.lines, ElementsAre(4u, 5u));
}

TEST_F(TableFile, TakesTheSeparatorOfTheFirstRow) {
    for (const auto* text : {"1,2,3\n4,5,6", "1;2;3\n4; 5 ;6\n", "1\t2\t3\n4\t5\t6\n", " 1  2 3 \n4 5   6\n",
                             "\xEF\xBB\xBF 1 2 3\n4 5 6\n"}) {
        const Table table = read(text);
        EXPECT_THAT(table.header, ElementsAre()) << text;
        EXPECT_THAT(table.rows, ElementsAre(ElementsAre(1, 2, 3), ElementsAre(4, 5, 6))) << text;
    }
}

TEST_F(TableFile, SaysWhichLineIsWrong) {
    const std::string name = "table: " + file_.string();
    EXPECT_THAT(error("x,y\n1,2\n3,4o\n"), HasSubstr(name + ":3: column 2: \"4o\" is no finite number"));
    EXPECT_THAT(error("1,y\n1,2\n"), HasSubstr(name + ":1: column 2: \"y\" is no finite number"));
    EXPECT_THAT(error("1,2\n3\n"), HasSubstr(name + ":2: 1 columns where the rows before have 2"));
    EXPECT_THAT(error("1,2\n3,\n"), HasSubstr(name + ":2: column 2: \"\" is no finite number"));
    EXPECT_THAT(error("1,2\n3,nan\n"), HasSubstr(name + ":2: column 2: \"nan\" is no finite number"));
    EXPECT_THAT(error("1,2\n3,1e999\n"), HasSubstr(name + ":2: column 2: \"1e999\" is no finite number"));
    EXPECT_THAT(error("1;2\n3;4,5\n"), HasSubstr(name + ":2: column 2: \"4,5\" is no finite number"));
    EXPECT_THAT(error("x,y\n"), HasSubstr(name + " holds no row of numbers"));
    EXPECT_THAT(error(""), HasSubstr(name + " holds no row of numbers"));
    EXPECT_THAT(error(std::string("1,\0\xFF\n", 5)), HasSubstr(name + ":1: column 2: "));
}

TEST_F(TableFile, RefusesWhatIsNoFileOrTooLarge) {
    EXPECT_THROW(read_table(folder_.path()), InputError);
    EXPECT_THROW(read_table(folder_.path() / "none.csv"), InputError);
    std::ofstream(file_) << "1\n";
    std::filesystem::resize_file(file_, (std::size_t{16} << 20) + 1);
    EXPECT_THROW(read_table(file_), InputError);
}

}  // namespace table_test
}  // namespace seampath
