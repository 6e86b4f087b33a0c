import pytest

from rtron.errors import InputError
from rtron.service.domain.oidc import OidcConfig
from rtron.service.domain.principal import UserRole
from rtron.service.server.oidc_setup import read_client_secret, read_oidc_config

GOOD = """
issuer = "https://login.example.org/realms/robots"
client_id = "rtron"
client_secret_file = "oidc.secret"
public_url = "https://robots.example.org/"
roles_claim = "realm_access.roles"

[roles]
robot-admins = ["admin"]
operators = ["end_user", "developer"]
"""


def write(folder, text):
    (folder / "oidc.toml").write_text(text)
    return folder / "oidc.toml"


def test_a_file_is_read_and_its_secret_lies_beside_it(tmp_path):
    (tmp_path / "oidc.secret").write_text("hush\n")
    config = read_oidc_config(write(tmp_path, GOOD))
    assert read_client_secret(config) == "hush"
    assert config.redirect_uri == "https://robots.example.org/api/v1/login/oidc/callback"
    assert config.roles["operators"] == {UserRole.END_USER, UserRole.DEVELOPER}


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"https://login', '"http://login', "issuer: .*https"),
        ('"https://robots', '"http://robots', "public_url: .*https"),
        ("/realms/robots", "/realms/robots?x=1", "issuer: .*without query"),
        ("[roles]", "[rolls]", "roles|rolls"),
        ('["admin"]', '["root"]', "roles.robot-admins"),
        ('client_id = "rtron"', "", "client_id"),
        ('client_id = "rtron"', 'client_id = "rtron"\nclient_secret = "x"', "client_secret"),
        ("[roles]", "[roles", "not TOML"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, old, new, said):
    with pytest.raises(InputError, match=said):
        read_oidc_config(write(tmp_path, GOOD.replace(old, new)))


def test_a_mapping_of_nothing_is_refused(tmp_path):
    with pytest.raises(InputError, match="roles"):
        read_oidc_config(write(tmp_path, GOOD.partition("[roles]")[0] + "[roles]\n"))


@pytest.mark.parametrize("content", [None, "", " \n"])
def test_a_secret_that_is_not_there_is_told(tmp_path, content):
    if content is not None:
        (tmp_path / "oidc.secret").write_text(content)
    with pytest.raises(InputError, match="secret"):
        read_client_secret(read_oidc_config(write(tmp_path, GOOD)))


def config(claim):
    return OidcConfig(
        issuer="https://login.example.org",
        client_id="rtron",
        public_url="https://robots.example.org",
        roles_claim=claim,
        roles={"a": ["admin"], "d": ["developer"]},
    )


@pytest.mark.parametrize(
    ("claim", "claims", "roles"),
    [
        ("groups", {"groups": ["a", "x"]}, {"admin"}),
        ("groups", {"groups": "d"}, {"developer"}),
        ("groups", {"groups": ["a", "d"]}, {"admin", "developer"}),
        ("groups", {"groups": ["A", "a ", "admin", 1, None, ["a"]]}, set()),
        ("groups", {"groups": {"a": True}}, set()),
        ("groups", {"groups": None}, set()),
        ("groups", {"roles": ["a"]}, set()),
        ("realm.roles", {"realm": {"roles": ["a"]}}, {"admin"}),
        ("https://x.org/roles", {"https://x.org/roles": ["a"]}, {"admin"}),
        ("realm.roles", {"realm": ["roles"]}, set()),
    ],
)
def test_only_what_is_mapped_gives_a_role(claim, claims, roles):
    assert config(claim).roles_of(claims) == roles
