-- One row for each segment: its newest state, and what that says, so that a question needs no state
-- to be read. Times are nanoseconds since 1970 in UTC, 0: not known.
create table if not exists state (
  vehicle text not null,
  truck text not null,
  start_ns integer not null,
  record integer not null,        -- of a record without a date: the beginning of its checksum
  seq integer not null,           -- samples: of two states the larger one counts
  end_ns integer not null,
  load text not null,
  moving_mass_kg real not null,
  basis text not null,            -- only states with the same one may be merged
  rate_hz real,
  coulomb_n real,
  coulomb_std_n real,
  stiffness_npm real,
  stiffness_std_npm real,
  trust text not null,
  light integer not null,
  checksum integer not null,      -- CRC-32C of the body
  body blob not null,             -- state.dls
  primary key (vehicle, truck, start_ns, record)
);
create table if not exists refused (
  file text primary key,
  reason text not null
);
-- Each truck: how much there is of it, its newest segment, and the mean of all that can be trusted,
-- weighted by their deviations. `dampline merge` is exact.
create view if not exists truck as
select vehicle, truck,
  count(*) as segments,
  round(sum(seq / coalesce(nullif(rate_hz, 0), 300.0)) / 3600, 3) as hours,
  datetime(max(end_ns) / 1000000000, 'unixepoch') as last_contact_utc,
  sum(coulomb_n / (coulomb_std_n * coulomb_std_n)) filter (where trust in ('trusted', 'model_incomplete'))
    / sum(1 / (coulomb_std_n * coulomb_std_n)) filter (where trust in ('trusted', 'model_incomplete')) as coulomb_n,
  sqrt(1 / sum(1 / (coulomb_std_n * coulomb_std_n)) filter (where trust in ('trusted', 'model_incomplete'))) as coulomb_std_n,
  sum(trust = 'data_faulty') as faulty_segments
from state group by vehicle, truck;
create view if not exists month as
select vehicle, truck, load, moving_mass_kg,
  strftime('%Y-%m', start_ns / 1000000000, 'unixepoch') as month,
  count(*) as segments,
  round(sum(seq / coalesce(nullif(rate_hz, 0), 300.0)) / 3600, 3) as hours,
  sum(coulomb_n / (coulomb_std_n * coulomb_std_n)) / sum(1 / (coulomb_std_n * coulomb_std_n)) as coulomb_n,
  sqrt(1 / sum(1 / (coulomb_std_n * coulomb_std_n))) as coulomb_std_n,
  sum(stiffness_npm / (stiffness_std_npm * stiffness_std_npm)) / sum(1 / (stiffness_std_npm * stiffness_std_npm)) as stiffness_npm,
  sqrt(1 / sum(1 / (stiffness_std_npm * stiffness_std_npm))) as stiffness_std_npm
from state where trust in ('trusted', 'model_incomplete')
group by vehicle, truck, load, moving_mass_kg, month;
