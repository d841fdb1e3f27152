#include "pipeline/fixture_history.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "pipeline/database.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kKept = "calibrations";

constexpr const char* kTable =
    "CREATE TABLE IF NOT EXISTS fixture_calibration ("
    "id INTEGER PRIMARY KEY, date TEXT NOT NULL, fixture TEXT NOT NULL, method TEXT NOT NULL, appraiser TEXT NOT NULL,"
    "part TEXT NOT NULL, pass INTEGER NOT NULL, accepted INTEGER NOT NULL, reason TEXT NOT NULL,"
    "x_mm REAL NOT NULL, y_mm REAL NOT NULL, z_mm REAL NOT NULL,"
    "qw REAL NOT NULL, qx REAL NOT NULL, qy REAL NOT NULL, qz REAL NOT NULL, expanded_mm REAL NOT NULL,"
    "work_points TEXT NOT NULL, nominal_sha256 TEXT NOT NULL, observations_sha256 TEXT NOT NULL, faults TEXT NOT NULL)";
constexpr const char* kColumns =
    "date,fixture,method,appraiser,part,pass,accepted,reason,x_mm,y_mm,z_mm,qw,qx,qy,qz,expanded_mm,work_points,"
    "nominal_sha256,observations_sha256,faults";

std::string work_points_text(const std::vector<WorkPoint>& points) {
    Json list = Json::array();
    for (const WorkPoint& w : points) {
        list.push_back({{"name", w.name}, {"p_mm", {w.p.x(), w.p.y(), w.p.z()}}});
    }
    return list.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::vector<WorkPoint> work_points_of(const std::string& text, const fs::path& file) {
    std::vector<WorkPoint> points;
    try {
        for (const Json& json : Json::parse(text)) {
            const auto p = json.at("p_mm").get<std::array<double, 3>>();
            points.push_back({json.at("name").get<std::string>(), {p[0], p[1], p[2]}});
        }
    } catch (const nlohmann::json::exception&) {
        throw InputError("history: " + file.string() + ": work points can't be read; check who wrote to it");
    }
    return points;
}

HistoryRow row_of(sqlite3_stmt* statement, const fs::path& file) {
    Columns c(statement);
    HistoryRow row;
    row.date = c.text();
    row.fixture = c.text();
    row.method = c.text();
    row.appraiser = c.text();
    row.part = c.text();
    row.pass = c.flag();
    row.accepted = c.flag();
    row.reason = c.text();
    Eigen::Vector3d p;
    Eigen::Vector4d q;
    for (double& value : p) {
        value = c.number();
    }
    for (double& value : q) {
        value = c.number();
    }
    row.base_from_part.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
    row.base_from_part.translation() = p;
    row.expanded_mm = c.number();
    row.work_points = work_points_of(c.text(), file);
    row.nominal_sha256 = c.text();
    row.observations_sha256 = c.text();
    row.faults = c.text();
    return row;
}

}  // namespace

void add_to_history(const fs::path& file, const HistoryRow& row) {
    Database database(file, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, kKept);
    database.run(kTable);
    const auto statement = database.prepare(std::string("INSERT INTO fixture_calibration (") + kColumns +
                                            ") VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
    Binder bind(database, statement.get());
    for (const auto* value : {&row.date, &row.fixture, &row.method, &row.appraiser, &row.part}) {
        bind.text(*value);
    }
    bind.flag(row.pass);
    bind.flag(row.accepted);
    bind.text(row.reason);
    const Eigen::Quaterniond q(row.base_from_part.linear());
    const Eigen::Vector3d p = row.base_from_part.translation();
    for (const double value : {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), row.expanded_mm}) {
        bind.number(value);
    }
    bind.text(work_points_text(row.work_points));
    for (const auto* value : {&row.nominal_sha256, &row.observations_sha256, &row.faults}) {
        bind.text(*value);
    }
    database.check(sqlite3_step(statement.get()));
}

std::vector<HistoryRow> read_history(const fs::path& file) {
    if (!fs::is_regular_file(file)) {
        throw InputError("history: there is no file " + file.string() +
                         "; the history.db in the --out folder of a calibration was needed");
    }
    Database database(file, SQLITE_OPEN_READONLY, kKept);
    const auto statement =
        database.prepare(std::string("SELECT ") + kColumns + " FROM fixture_calibration ORDER BY id");
    std::vector<HistoryRow> rows;
    int status = SQLITE_ROW;
    while ((status = sqlite3_step(statement.get())) == SQLITE_ROW) {
        rows.push_back(row_of(statement.get(), file));
    }
    database.check(status);
    return rows;
}

HistoryRow history_row(const FixtureCalibration& c) {
    HistoryRow row;
    row.date = c.date;
    row.fixture = c.nominal.name;
    row.method = kFixtureMethodNames[static_cast<std::size_t>(c.nominal.method)];
    row.pass = c.frame.pass();
    row.accepted = c.accepted.has_value();
    row.reason = c.accepted ? c.accepted->reason : "";
    row.base_from_part = c.frame.base_from_part;
    for (const WorkPointResult& w : c.frame.work_points) {
        row.expanded_mm = std::max(row.expanded_mm, w.expanded_mm);
    }
    row.work_points = c.nominal.work_points;
    row.nominal_sha256 = c.inputs.at(0).sha256;
    row.observations_sha256 = c.inputs.at(1).sha256;
    for (const auto& fault : c.frame.faults) {
        row.faults += (row.faults.empty() ? "" : "\n") + fault;
    }
    return row;
}

}  // namespace seampath
