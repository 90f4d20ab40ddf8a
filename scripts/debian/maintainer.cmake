# What who gives packages away fills in; nothing else names a person or an address. Left empty, a package is from
# who built it, as Debian's own tools have it: DEBFULLNAME and DEBEMAIL of the environment.
set(ORCHARD_MAINTAINER "")  # such as "Ana Soto <ana@example.org>"
set(ORCHARD_HOMEPAGE "")    # the repository's page
