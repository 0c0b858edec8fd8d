-- What SQLite and PostgreSQL hold of a fleet. Times are nanoseconds since 1970 in UTC, 0: not known.
create table fleet_schema (
  version bigint not null
);
-- One row for each segment: its newest state, and what that says, so that a question needs no state
-- to be read.
create table state (
  vehicle text not null,
  truck text not null,
  start_ns bigint not null,
  record bigint not null,         -- of a record without a date: the beginning of its checksum
  seq bigint not null,            -- samples: of two states the larger one counts
  end_ns bigint not null,
  load text not null,
  moving_mass_kg double precision not null,
  basis text not null,            -- only states with the same one may be merged
  rate_hz double precision,
  coulomb_n double precision,
  coulomb_std_n double precision,
  stiffness_npm double precision,
  stiffness_std_npm double precision,
  trust text not null,
  light bigint not null,
  checksum bigint not null,       -- CRC-32C of the body
  hours double precision not null,
  usable bigint not null,         -- 1: its level counts: it can be trusted, and is a number
  alarms text not null,           -- raised in it: "coulomb_below, drift"
  body bytea not null,            -- state.dls
  primary key (vehicle, truck, start_ns, record)
);
create table refused (
  file text primary key,
  reason text not null
);
-- One row for each truck and load: what its segments say together. Written with them; docs/reference.md.
create table trend (
  vehicle text not null,
  truck text not null,
  load text not null,
  moving_mass_kg double precision not null,
  segments bigint not null,
  usable_segments bigint not null,
  faulty_segments bigint not null,
  hours double precision not null,
  first_ns bigint not null,
  last_ns bigint not null,
  last_contact_utc text,
  newest_trust text not null,
  newest_alarms text not null,    -- of its newest segment
  mean_n double precision,        -- of all usable segments, weighted by their deviations
  mean_std_n double precision,
  level_n double precision,       -- the same of the newest week
  level_std_n double precision,
  change_n double precision,      -- from the mean of what is before
  change_std_n double precision,
  trend_n_per_year double precision,
  trend_std_n_per_year double precision,
  scatter double precision,       -- of the segments about that line, in their deviations
  stiffness_npm double precision, -- of the newest week
  stiffness_std_npm double precision,
  primary key (vehicle, truck, load, moving_mass_kg)
);
