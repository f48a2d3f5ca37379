!> The files of a run: parcels.vtkhdf, walls.vtkhdf, gas.vtkhdf and monitor.h5.
module results
  use bed, only: bed_t, up_axis, pressure_drop, bed_heights
  use case, only: case_t
  use chamber, only: chamber_t
  use constants, only: is_set
  use gas, only: gas_t
  use kinds, only: wp
  use ledger, only: ledger_t
  use monitors, only: monitors_t
  use outcome, only: outcome_t
  use overlap_report, only: overlap_report_t
  use parcels, only: parcels_t, radius_row, velocity_row, spin_row, drag_row, mass_row
  use provenance, only: provenance_t
  use scene, only: scene_t, parts
  use schedule, only: schedule_t, new_schedule
  use series_file, only: series_file_t, column_t
  use size_audit, only: size_audit_t, quantity_names, quantity_units
  use solids_statistics, only: statistics_t, find_statistics
  use vtkhdf_gas, only: vtkhdf_gas_t
  use vtkhdf_parcels, only: vtkhdf_parcels_t
  use vtkhdf_walls, only: vtkhdf_walls_t
  implicit none
  private
  public :: results_t

  type :: results_t
    type(vtkhdf_parcels_t) :: parcels_file
    type(vtkhdf_walls_t) :: walls_file         !< of meshes; as often as that of the parcels, once if none moves
    type(vtkhdf_gas_t) :: gas_file
    type(series_file_t) :: series              !< of the bed as a whole, and of the monitors
    integer :: table = 0                       !< of the series: the bed as a whole
    type(monitors_t) :: monitors
    logical :: every_step = .false.            !< whether the series is written after every step
    type(schedule_t) :: parcels_due, gas_due, series_due
    logical :: parcels_open = .false., walls_open = .false., gas_open = .false.
    integer :: up = 2                          !< see module bed
    real(wp) :: gravity = 0                    !< size of it [m/s2]
    real(wp) :: lower(3), upper(3)             !< corners of the domain [m]
    type(bed_t) :: bed                         !< when it was looked at last
    type(statistics_t) :: statistics           !< of the parcels, then
    type(overlap_report_t) :: overlaps         !< of all records
  contains
    procedure :: open => open_results
    procedure :: look
    procedure :: write_due
    procedure :: write_all
    procedure :: annotate
    procedure :: close => close_results
  end type results_t

contains

  !> Begin the files, or go on with them after the time of a restart.
  subroutine open_results(self, folder, case, scene, origin, outcome, after)
    class(results_t), intent(inout) :: self
    character(len=*), intent(in) :: folder
    type(case_t), intent(in) :: case
    type(scene_t), intent(in) :: scene
    type(provenance_t), intent(in) :: origin
    type(outcome_t), intent(inout) :: outcome
    real(wp), intent(in), optional :: after  !< [s]

    self%up = up_axis(case%domain%gravity)
    self%gravity = norm2(case%domain%gravity)
    self%lower = case%domain%lower
    self%upper = case%domain%upper
    if (scene%with_parcels) self%parcels_due = new_schedule(case%output%parcels_interval, after)
    if (scene%with_gas) self%gas_due = new_schedule(case%output%gas_interval, after)
    self%series_due = new_schedule(case%output%monitor_interval, after)
    self%every_step = .not. is_set(case%output%monitor_interval)
    self%parcels_open = self%parcels_due%recurs()
    self%gas_open = self%gas_due%recurs()
    if (self%parcels_open) call self%parcels_file%open(folder//'/parcels.vtkhdf', scene%comm, origin, outcome, after)
    if (outcome%failed()) return
    if (self%parcels_open) self%walls_open = scene%solids%chamber%n_meshes > 0
    if (self%walls_open) call self%walls_file%open(folder//'/walls.vtkhdf', scene%comm, origin, outcome, after)
    if (outcome%failed()) return
    if (self%gas_open) call self%gas_file%open(folder//'/gas.vtkhdf', scene%boxes, scene%mesh, origin, outcome, after)
    if (outcome%failed()) return
    call self%series%open(folder//'/monitor.h5', scene%comm, origin, outcome, after)
    if (outcome%failed()) return
    call self%series%add_table('/series', columns_of(scene), self%table)
    if (scene%with_gas) then
      call self%monitors%create(case%monitors, case%output%monitor_interval, scene%mesh, self%series, after, scene%boxes, &
                                scene%gas%space)
    else
      call self%monitors%create(case%monitors, case%output%monitor_interval, scene%mesh, self%series, after)
    end if
  end subroutine open_results

  !> What is recorded of every run.
  function columns_of(scene) result(columns)
    type(scene_t), intent(in) :: scene
    type(column_t), allocatable :: columns(:)

    integer :: i

    columns = [column_t('gas_step', 's', 'length of the last gas step, time_step/2**n'), &
               column_t('wall_time', 's', 'since the start of this program, of the first rank'), &
               (column_t('wall_time_'//parts(i), 's', 'of that in this part'), i=1, size(parts)), &
               column_t('wall_time_other', 's', 'of that in all the rest')]
    if (scene%with_parcels) columns = [columns, &
      column_t('parcels', '1', 'number of parcels'), &
      column_t('parcel_mass', 'kg', 'mass of all parcels'), &
      column_t('parcels_left', '1', 'gone through open faces since the start'), &
      column_t('parcels_lost', '1', 'expected less found'), &
      column_t('bed_height', 'm', 'below which 95 % of the parcel mass lies'), &
      column_t('mean_height', 'm', 'of the parcel mass'), &
      column_t('kinetic_energy', 'J', 'of all parcels, rotation included'), &
      column_t('max_overlap', '1', 'largest overlap over the smaller radius'), &
      column_t('mean_overlap', '1', 'mean over all contacts of parcels, of the same ratio'), &
      column_t('overlap_beyond_1', '1', 'share of contacts that overlap by more than 1 % of the smaller radius'), &
      column_t('overlap_beyond_5', '1', 'the same, 5 %'), &
      column_t('overlap_beyond_10', '1', 'the same, 10 %'), &
      column_t('contacts', '1', 'between parcels'), &
      column_t('solids_steps', '1', 'since the start'), &
      column_t('list_rebuilds', '1', 'neighbour lists made since the start')]
    if (scene%with_gas) columns = [columns, &
      column_t('pressure_drop', 'Pa', 'of the gas, lowest face to highest'), &
      column_t('gas_iterations', '1', 'SIMPLE iterations of the last step'), &
      column_t('pressure_iterations', '1', 'of the pressure solver in the last step'), &
      column_t('mass_imbalance', '1', 'gas: |inflow - outflow - accumulation| over the inflow, last step'), &
      column_t('mass_residual', '1', 'gas: sum of the imbalances of all cells over the inflow, last step'), &
      column_t('momentum_residual', '1', 'gas: of the last step'), &
      column_t('courant', '1', 'largest |u| dt/h of the last step'), &
      column_t('gas_inflow', 'kg/s', 'last step'), column_t('gas_outflow', 'kg/s', 'last step'), &
      column_t('gas_steps', '1', 'since the start'), &
      column_t('gas_retries', '1', 'steps repeated with half the length, since the start')]
    if (scene%with_gas) then
      if (is_driven(scene%gas)) columns = [columns, column_t('periodic_pressure_drop', 'Pa', &
        'by which the pressure falls across the domain, along periodic directions, last step', 3)]
    end if
    if (scene%with_gas .and. scene%with_parcels) columns = [columns, &
      column_t('weight_per_area', 'Pa', 'of all parcels over the cross-section, its mean where walls block the gas'), &
      column_t('exchange_residual', '1', 'momentum not balanced between gas and parcels, last step'), &
      column_t('least_void_fraction', '1', 'of any cell, before clipping'), &
      column_t('clipped_volume', 'm3', 'of solids the gas does not see, last step')]
  end function columns_of

  !> Whether anything but boundaries and gravity drives the gas.
  pure function is_driven(gas)
    type(gas_t), intent(in) :: gas
    logical :: is_driven

    is_driven = any(gas%driving%held) .or. any(abs(gas%driving%drop) > 0)
  end function is_driven

  !> Look at the bed and the parcels as they are now. All ranks take part.
  subroutine look(self, scene)
    class(results_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene

    integer :: a

    a = abs(self%up)
    self%bed = bed_t()
    if (scene%with_parcels) then
      self%statistics = find_statistics(scene%solids)
      call self%overlaps%enter(self%statistics)
      self%bed%weight_per_area = self%statistics%mass*self%gravity*(self%upper(a) - self%lower(a)) &
        /product(self%upper - self%lower)
      if (scene%with_gas) then
        if (allocated(scene%gas%space)) self%bed%weight_per_area = self%bed%weight_per_area &
          *product(self%upper - self%lower)/scene%gas%space%open_volume
      end if
      associate (p => scene%solids%parcels)
        call bed_heights(scene%comm, self%lower, self%upper, self%up, p%state(1:3, 1:p%n), 1/p%state(mass_row, 1:p%n), &
                         self%bed)
      end associate
    end if
    if (.not. scene%with_gas) return
    if (allocated(scene%gas%space)) then
      self%bed%pressure_drop = pressure_drop(scene%boxes, self%up, scene%gas%pressure, scene%gas%space%volume)
    else
      self%bed%pressure_drop = pressure_drop(scene%boxes, self%up, scene%gas%pressure)
    end if
  end subroutine look

  !> Keep what the powders were to be and what they became.
  subroutine annotate(self, audits)
    class(results_t), intent(inout) :: self
    type(size_audit_t), intent(in) :: audits(:)

    character(len=:), allocatable :: names
    type(column_t) :: none(0)
    integer :: i, table

    call self%series%add_table('/powders', none, table)
    names = ''
    do i = 1, size(quantity_names)
      names = names//trim(quantity_names(i))//' ['//trim(quantity_units(i))//']; '
    end do
    call self%series%annotate(table, 'quantities', text=names)
    do i = 1, size(audits)
      call self%series%annotate(table, trim(audits(i)%powder), unit='SI', &
        numbers=transpose(reshape([audits(i)%asked%values, audits(i)%made%values], [size(quantity_names), 2])))
    end do
  end subroutine annotate

  !> Write whatever the time has come for.
  subroutine write_due(self, scene, ledger, seconds, outcome)
    class(results_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    type(ledger_t), intent(in) :: ledger
    real(wp), intent(in) :: seconds(:)  !< of wall time in each part, and in all the rest
    type(outcome_t), intent(inout) :: outcome

    if (self%every_step .or. self%series_due%is_due(scene%time)) call write_series(self, scene, ledger, seconds)
    if (self%monitors%any_due(scene%time)) call write_monitors(self, scene)
    if (self%parcels_due%is_due(scene%time)) then
      call self%parcels_due%done(scene%time)
      call write_parcels(self%parcels_file, scene%time, scene%solids%parcels, outcome)
      if (self%walls_open .and. .not. outcome%failed()) call write_walls(self%walls_file, scene%time, scene%solids%chamber, outcome)
    end if
    if (self%gas_due%is_due(scene%time)) then
      call self%gas_due%done(scene%time)
      call write_gas(self%gas_file, scene%time, scene%gas, outcome)
    end if
  end subroutine write_due

  !> Write everything there is a file for, whatever the time: the last frame of a run that failed.
  subroutine write_all(self, scene, ledger, seconds, outcome)
    class(results_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    type(ledger_t), intent(in) :: ledger
    real(wp), intent(in) :: seconds(:)  !< of wall time in each part, and in all the rest
    type(outcome_t), intent(inout) :: outcome

    call write_series(self, scene, ledger, seconds)
    if (self%parcels_open) call write_parcels(self%parcels_file, scene%time, scene%solids%parcels, outcome)
    if (self%gas_open .and. .not. outcome%failed()) call write_gas(self%gas_file, scene%time, scene%gas, outcome)
  end subroutine write_all

  subroutine write_series(self, scene, ledger, seconds)
    class(results_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene
    type(ledger_t), intent(in) :: ledger
    real(wp), intent(in) :: seconds(:)

    call self%series_due%done(scene%time)
    call self%look(scene)
    call self%series%append(self%table, scene%time, row_of(self, scene, ledger, seconds))
  end subroutine write_series

  subroutine write_monitors(self, scene)
    class(results_t), intent(inout) :: self
    type(scene_t), intent(in) :: scene

    if (scene%with_gas) then
      associate (gas => scene%gas)
        if (allocated(gas%ideal)) then
          call self%monitors%measure_gas(gas%pressure, gas%eps, gas%velocity, gas%flux, gas%ideal%density, gas%space)
        else
          call self%monitors%measure_gas(gas%pressure, gas%eps, gas%velocity, gas%flux, space=gas%space)
        end if
      end associate
    end if
    if (scene%with_parcels) then
      associate (p => scene%solids%parcels)
        call self%monitors%measure_parcels(p%state(1:3, :p%n), p%state(velocity_row:velocity_row + 2, :p%n), &
                                           p%state(mass_row, :p%n), p%diameter(:p%n), p%weight(:p%n))
      end associate
    end if
    call self%monitors%record(scene%time, scene%comm, self%series)
  end subroutine write_monitors

  !> The numbers of a row, in the order of columns_of.
  function row_of(self, scene, ledger, seconds) result(row)
    class(results_t), intent(in) :: self
    type(scene_t), intent(in) :: scene
    type(ledger_t), intent(in) :: ledger
    real(wp), intent(in) :: seconds(:)
    real(wp), allocatable :: row(:)

    row = [scene%report%dt, sum(seconds), seconds]
    if (scene%with_parcels) then
      associate (s => self%statistics)
        row = [row, real(s%parcels, wp), s%mass, real(s%left, wp), real(s%lost, wp), self%bed%height, &
          self%bed%mean_height, s%kinetic_energy, s%max_overlap, s%mean_overlap, s%beyond, &
          real(s%contacts, wp), ledger%solids_steps, real(s%rebuilds, wp)]
      end associate
    end if
    if (scene%with_gas) then
      associate (r => scene%gas%report)
        row = [row, self%bed%pressure_drop, real(r%iterations, wp), real(r%pressure_iterations, wp), &
          r%mass_imbalance, r%mass_residual, r%momentum_residual, r%courant, r%inflow, r%outflow, &
          ledger%gas_steps, ledger%retries]
      end associate
      if (is_driven(scene%gas)) row = [row, scene%gas%driving%drop]
    end if
    if (scene%with_gas .and. scene%with_parcels) then
      associate (e => scene%coupling%exchange)
        row = [row, self%bed%weight_per_area, e%momentum_residual, e%least_void_fraction, e%clipped_volume]
      end associate
    end if
  end function row_of

  subroutine write_parcels(file, time, p, outcome)
    type(vtkhdf_parcels_t), intent(inout) :: file
    real(wp), intent(in) :: time  !< [s]
    type(parcels_t), intent(in) :: p
    type(outcome_t), intent(inout) :: outcome

    integer :: a

    associate (n => p%n, radius => p%state(radius_row, :p%n))
      call file%begin_step(time, p%state(1:3, :n))
      call file%add('velocity', p%state(velocity_row:velocity_row + 2, :n), 'm/s')
      call file%add('diameter', p%diameter(:n), 'm')
      call file%add('collision_diameter', 2*radius, 'm')
      call file%add('weight', p%weight(:n), '1')
      call file%add('mass', 1/p%state(mass_row, :n), 'kg')
      call file%add('id', p%id(:n), '1')
      call file%add('powder', p%powder(:n), '1')
      if (p%rotation) call file%add('angular_velocity', &
        reshape([((p%state(spin_row:spin_row + 2, a)/radius(a)), a=1, n)], [3, n]), 'rad/s')
      if (p%with_gas) call file%add('drag_acceleration', p%coupled(drag_row:drag_row + 2, :n), 'm/s2')
    end associate
    call file%end_step(outcome)
  end subroutine write_parcels

  subroutine write_walls(file, time, chamber, outcome)
    type(vtkhdf_walls_t), intent(inout) :: file
    real(wp), intent(in) :: time  !< [s]
    type(chamber_t), intent(in) :: chamber
    type(outcome_t), intent(inout) :: outcome

    real(wp), allocatable :: corners(:,:,:)
    integer, allocatable :: number(:)
    integer :: m, t, k

    if (file%steps > 0 .and. .not. chamber%fastest > 0.0_wp) return
    associate (last => chamber%meshes(chamber%n_meshes))
      allocate (corners(3, 3, last%before + last%n), number(last%before + last%n))
    end associate
    do m = 1, chamber%n_meshes
      associate (wall => chamber%meshes(m))
        number(wall%before + 1:wall%before + wall%n) = m
        do t = 1, wall%n
          do k = 1, 3
            corners(:, k, wall%before + t) = wall%place_of(wall%shape(:, k, t))
          end do
        end do
      end associate
    end do
    call file%write_step(time, corners, number, outcome)
  end subroutine write_walls

  subroutine write_gas(file, time, gas, outcome)
    type(vtkhdf_gas_t), intent(inout) :: file
    real(wp), intent(in) :: time  !< [s]
    type(gas_t), intent(in) :: gas
    type(outcome_t), intent(inout) :: outcome

    real(wp), allocatable :: velocity(:,:,:,:)

    associate (n => gas%boxes%n)
      allocate (velocity(3, n(1), n(2), n(3)))
      call gas%cell_velocity(velocity)
      call file%begin_step(time)
      call file%add('void_fraction', gas%eps(1:n(1), 1:n(2), 1:n(3)), '1')
      if (allocated(gas%space)) call file%add('open_fraction', gas%space%volume(1:n(1), 1:n(2), 1:n(3)), '1')
      call file%add('pressure', gas%pressure(1:n(1), 1:n(2), 1:n(3)), 'Pa')
      if (allocated(gas%ideal)) call file%add('density', gas%ideal%density(1:n(1), 1:n(2), 1:n(3)), 'kg/m3')
      call file%add('velocity', velocity, 'm/s')
      if (allocated(gas%eddies)) call file%add('eddy_viscosity', gas%eddies%viscosity, 'Pa s')
      call file%end_step(outcome)
    end associate
  end subroutine write_gas

  subroutine close_results(self, outcome)
    class(results_t), intent(inout) :: self
    type(outcome_t), intent(inout) :: outcome

    if (self%parcels_open) call self%parcels_file%close(outcome)
    if (self%gas_open) call self%gas_file%close(outcome)
    if (self%table > 0) call self%series%close(outcome)
  end subroutine close_results

end module results
