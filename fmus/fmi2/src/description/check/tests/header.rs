//! Planted mistakes in the root element, the capabilities, and the lists around them.

use super::{GOOD, findings, planted};

#[test]
fn mistakes_in_the_root_element_are_found() {
    insta::assert_snapshot!(planted(&[
        ("fmiVersion=\"2.0\"", "fmiVersion=\"2.0.1\""),
        ("fmiVersion=\"2.0\"", ""),
        ("modelName=\"Tank\"", "modelName=\"\""),
        ("guid=\"{8c4e810f}\"", ""),
        ("2024-05-31T23:59:59Z", "2024-05-31T23:59:59+02:00"),
        ("2024-05-31T23:59:59Z", "Fri May 31 23:59:59 2024"),
        ("2024-05-31T23:59:59Z", "2024-13-31T23:59:59Z"),
        ("\"structured\"", "\"nested\""),
        ("numberOfEventIndicators=\"0\"", "numberOfEventIndicators=\"none\""),
        ("numberOfEventIndicators=\"0\"", "numberOfContinuousStates=\"1\""),
        ("</ModelVariables>", "</ModelVariables><Extra/>"),
        ("</LogCategories>", "</LogCategories><LogCategories/>"),
        ("<UnitDefinitions>", "<DefaultExperiment/><UnitDefinitions>"),
    ]));
}

#[test]
fn a_description_needs_an_interface_variables_and_a_structure() {
    let empty = "<fmiModelDescription fmiVersion='2.0' modelName='Empty' guid='1'/>";
    let exchange = GOOD.replace("<CoSimulation", "<ModelExchange").replace("</CoSimulation", "</ModelExchange");
    insta::assert_snapshot!(format!("{}\n{}", findings(empty), findings(&exchange)));
}

#[test]
fn mistakes_in_the_capabilities_are_found() {
    insta::assert_snapshot!(planted(&[
        ("modelIdentifier=\"tank\"", ""),
        ("modelIdentifier=\"tank\"", "modelIdentifier=\"my tank\""),
        ("modelIdentifier=\"tank\"", "modelIdentifier=\"2tank\""),
        ("canGetAndSetFMUstate=\"true\" ", ""),
        ("canGetAndSetFMUstate=\"true\"", "canGetAndSetFMUstate=\"yes\""),
        ("canSerializeFMUstate=\"true\"", "canSerializeFMUstate=\"True\""),
        ("canSerializeFMUstate=\"true\"", "canSerializeFMUState=\"true\""),
        ("canSerializeFMUstate=\"true\"", "maxOutputDerivativeOrder=\"-1\""),
        ("name=\"tank.c\"", "name=\"..\\\\tank.c\""),
        ("name=\"tank.c\"", "name=\"/tmp/tank.c\""),
        ("<File name=\"tank.c\"/>", ""),
        ("<File name=\"tank.c\"/>", "<File name=\"a.c\"/>\n<File name=\"b.c\"/>\n<File name=\"a.c\"/>"),
        ("<File name=\"tank.c\"/>", "<File/>"),
        ("<File name=\"tank.c\"/>", "<File name=\"./gc/x.c\"/>"),
        ("<File name=\"tank.c\"/>", "<File name=\"gc//x.c\"/>\n<File name=\"./y.c\"/>\n<File name=\"gc/./z.c\"/>"),
        ("<SourceFiles>", "<Sources/><SourceFiles>"),
    ]));
}

#[test]
fn mistakes_in_categories_experiment_and_tools_are_found() {
    insta::assert_snapshot!(planted(&[
        ("name=\"logEvents\"", "name=\"logAll\""),
        ("name=\"logEvents\"", ""),
        ("stopTime=\"10\"", "stopTime=\"-1\""),
        ("stopTime=\"10\"", "stopTime=\"NaN\""),
        ("stopTime=\"10\"", "stopTime=\"10,5\""),
        ("stopTime=\"10\"", "stopTime=\"ten\""),
        ("stopTime=\"10\"", "stopTime=\"0.05\""),
        ("tolerance=\"1e-6\"", "tolerance=\"0\""),
        ("stepSize=\"0.1\"", "stepSize=\"-INF\""),
        ("stepSize=\"0.1\"", "stepSize=\"-0.1\""),
        ("<Tool name=\"Lockstep\"/>", "<Tool/>"),
        ("<Tool name=\"Lockstep\"/>", "<Tool name=\"A\"/>\n<Tool name=\"B\"/>\n<Tool name=\"A\"/>"),
    ]));
}

#[test]
fn mistakes_in_model_exchange_are_found() {
    let planted = |element: &str| planted(&[("<CoSimulation", &format!("{element}<CoSimulation"))]);
    insta::assert_snapshot!(
        [
            planted("<ModelExchange/>"),
            planted("<ModelExchange modelIdentifier=\"2tank\" maxOutputDerivativeOrder=\"1\"/>"),
            planted(
                "<ModelExchange modelIdentifier=\"tank\"><SourceFiles>\n<File name=\"a.c\"/>\n<File name=\"../b.c\"/>\n\
                 <File name=\"a.c\"/></SourceFiles></ModelExchange>"
            ),
            planted("<ModelExchange modelIdentifier=\"tank\"><SourceFiles/></ModelExchange>"),
        ]
        .concat()
    );
}
