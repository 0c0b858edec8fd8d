-- The database of a fleet and who uses it: `collector` owns it and writes, `reader` (page, metrics,
-- people) reads. Passwords: \password collector, in psql.
create role collector login;
create role reader login;
create database dampline owner collector encoding 'UTF8' locale 'C' template template0;
revoke all on database dampline from public;
grant connect on database dampline to reader;
\connect dampline
revoke create on schema public from public;
grant all on schema public to collector;
grant usage on schema public to reader;
alter default privileges for role collector in schema public grant select on tables to reader;
