//! Reports as JUnit XML, which CI systems read.

use core::time::Duration;

use quick_junit::{NonSuccessKind, Report as JunitReport, TestCase, TestCaseStatus, TestSuite};

use super::report::Report;
use crate::text::SceneError;

/// The reports of a suite as JUnit XML: a test suite per scene, a test case per expectation, and one more: "nothing is
/// refused", which lists everything that the plugin refused, or "it can be loaded", which gives the error in the file.
///
/// # Errors
/// [`SceneError`] if it cannot be written as XML.
pub fn to_junit<'a>(name: &str, reports: impl IntoIterator<Item = &'a Report>) -> Result<String, SceneError> {
    let mut junit = JunitReport::new(name);
    for report in reports {
        let mut suite = TestSuite::new(report.scene.as_str());
        suite.set_time(Duration::from_secs_f64(report.wall_s.max(0.0)));
        for verdict in &report.verdicts {
            let status = if verdict.passed {
                TestCaseStatus::success()
            } else {
                failure(report, &verdict.to_string())
            };
            let mut case = TestCase::new(verdict.title.as_str(), status);
            case.set_classname(report.scene.as_str());
            suite.add_test_case(case);
        }
        let status = if report.problems.is_empty() {
            TestCaseStatus::success()
        } else {
            failure(report, &report.problems.join("\n"))
        };
        // A scene that took no step was not loaded.
        let title = if report.steps == 0 { "it can be loaded" } else { "nothing is refused" };
        let mut case = TestCase::new(title, status);
        case.set_classname(report.scene.as_str());
        suite.add_test_case(case);
        // The report includes measured values and values that are only reported.
        suite.set_system_out(report.to_string());
        junit.add_test_suite(suite);
    }
    junit.to_string().map_err(SceneError::new)
}

fn failure(report: &Report, message: &str) -> TestCaseStatus {
    let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
    status.set_message(message);
    status.set_description(report.complaint());
    status
}
