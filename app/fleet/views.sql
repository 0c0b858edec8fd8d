-- What people ask. `segment`, which each database has its own way of, is in store/.
create view month as
select vehicle, truck, load, moving_mass_kg, month,
  count(*) as segments, sum(hours) as hours,
  sum(coulomb_n / (coulomb_std_n * coulomb_std_n)) / sum(1 / (coulomb_std_n * coulomb_std_n)) as coulomb_n,
  sqrt(1 / sum(1 / (coulomb_std_n * coulomb_std_n))) as coulomb_std_n,
  sum(stiffness_npm / (stiffness_std_npm * stiffness_std_npm)) / sum(1 / (stiffness_std_npm * stiffness_std_npm)) as stiffness_npm,
  sqrt(1 / sum(1 / (stiffness_std_npm * stiffness_std_npm))) as stiffness_std_npm
from segment where usable = 1
group by vehicle, truck, load, moving_mass_kg, month;

-- Each truck: how much there is of it, its newest contact, and the mean of all that can be trusted.
create view truck as
select vehicle, truck, cast(sum(segments) as bigint) as segments, sum(hours) as hours,
  max(last_contact_utc) as last_contact_utc,
  sum(mean_n / (mean_std_n * mean_std_n)) / sum(1 / (mean_std_n * mean_std_n)) as coulomb_n,
  sqrt(1 / sum(1 / (mean_std_n * mean_std_n))) as coulomb_std_n,
  cast(sum(faulty_segments) as bigint) as faulty_segments,
  max(case when newest = 1 then newest_trust end) as newest_trust,
  max(case when newest = 1 then newest_alarms end) as newest_alarms,
  max(last_ns) as last_ns
from (
  select trend.*, row_number() over (
    partition by vehicle, truck order by last_ns desc, load, moving_mass_kg) as newest
  from trend) as loads
group by vehicle, truck;

-- What trucks are told apart by, a row for each.
create view figure as
select vehicle, truck, load, moving_mass_kg, last_contact_utc, 'level' as quantity, 'N' as unit,
  level_n as value, level_std_n as std from trend where level_n is not null
union all
select vehicle, truck, load, moving_mass_kg, last_contact_utc, 'change', 'N',
  change_n, change_std_n from trend where change_n is not null
union all
select vehicle, truck, load, moving_mass_kg, last_contact_utc, 'trend', 'N/year',
  trend_n_per_year, trend_std_n_per_year from trend where trend_n_per_year is not null
union all
select vehicle, truck, load, moving_mass_kg, last_contact_utc, 'stiffness', 'N/m',
  stiffness_npm, stiffness_std_npm from trend where stiffness_npm is not null;

-- The trucks of one load: median, and scatter about it as 0.7413 times the distance of the
-- quartiles, which is the standard deviation of what is normally distributed and does not see the
-- outliers.
create view norm as
select load, moving_mass_kg, quantity, unit, trucks,
  avg(case when place in ((trucks + 1) / 2, (trucks + 2) / 2) then value end) as median,
  0.7413 * (max(case when place = trucks + 1 - (trucks + 3) / 4 then value end)
    - max(case when place = (trucks + 3) / 4 then value end)) as scatter
from (
  select load, moving_mass_kg, quantity, unit, value,
    row_number() over (partition by load, moving_mass_kg, quantity order by value) as place,
    count(*) over (partition by load, moving_mass_kg, quantity) as trucks
  from figure) as ranked
group by load, moving_mass_kg, quantity, unit, trucks;

-- Trucks that differ from those of their load by more than 4.5 standard deviations of both, where
-- there are 20 or more of these: docs/reference.md.
create view outlier as
select figure.vehicle, figure.truck, figure.load, figure.moving_mass_kg, figure.quantity, figure.unit,
  value, std, median, scatter,
  (value - median) / sqrt(std * std + scatter * scatter) as deviations, trucks, last_contact_utc
from figure join norm on norm.load = figure.load
  and norm.moving_mass_kg = figure.moving_mass_kg and norm.quantity = figure.quantity
where trucks >= 20 and abs(value - median) > 4.5 * sqrt(std * std + scatter * scatter);
