"""What the console asks of a slow line: what comes once, from the cache, or with its view."""


def test_what_is_shown_first_is_asked_for_once_and_the_rest_comes_from_the_cache(console, cold):
    cold.browser.get(console.base)
    cold.wait_for_text("No robot is known yet")
    names = cold.browser.execute_script(
        "return performance.getEntriesByType('resource')"
        ".filter((each) => each.name.endsWith('/api/v1/me')).map((each) => each.initiatorType);"
    )
    assert names == ["link"]
    cold.browser.refresh()
    cold.wait_for_text("No robot is known yet")
    again = cold.browser.execute_script(
        "return performance.getEntriesByType('resource')"
        ".filter((each) => each.name.includes('/console/') && each.transferSize > 0)"
        ".map((each) => each.name);"
    )
    assert again == []


def test_libraries_for_one_view_come_with_that_view(console, guard, cold):
    cold.browser.get(console.base)
    cold.wait_for_text("turtle1")
    scripts = "return [...document.scripts].map((each) => each.src.split('/').at(-1));"
    assert cold.browser.execute_script(scripts) == ["theme.js", "main.js"]
    cold.go("robots/turtle1/graph")
    cold.find(".picture .press")
    assert cold.browser.execute_script(scripts)[2:] == ["later.js", "dagre.min.js"]
    cold.go("robots/turtle1/nodes/grcn_cmd_vel")
    cold.find(".chart canvas")
    assert "uplot.min.js" in cold.browser.execute_script(scripts)
