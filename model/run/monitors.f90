!> The monitors of a case: quantities of gas and parcels in named regions, at their own intervals, into monitor.h5.
!>
!>   call monitors%create(settings, interval, mesh, series, after, boxes, space)
!>   if (monitors%any_due(time)) then
!>     call monitors%measure_gas(pressure, eps, velocity, flux, density, space)
!>     call monitors%measure_parcels(position, velocity, inverse_mass, diameter, weight)
!>     call monitors%record(time, comm, series)
!>   end if
!>
!> Every rank measures what it has; `record` adds up. Each monitor is a group /monitors/ID of the file.
module monitors
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use boxes, only: boxes_t
  use communicator, only: communicator_t
  use constants, only: is_set, pi
  use kinds, only: wp
  use mesh, only: mesh_t
  use monitor_quantities, only: quantities, find_quantity
  use monitor_region, only: sample_t, new_samples, weigh_cells, weigh_faces, weighted_sum
  use monitor_settings, only: monitor_settings_t
  use open_space, only: open_space_t
  use schedule, only: schedule_t, new_schedule
  use series_file, only: series_file_t, column_t
  implicit none
  private
  public :: monitors_t

  integer, parameter :: most_sums = 5   !< that any quantity needs

  type :: monitor_t
    integer :: place                          !< of its quantity in `quantities`
    integer :: normal                         !< axis of a flux
    integer :: table                          !< of the series file
    logical :: every_step                     !< whether it is due always; otherwise by its schedule
    logical :: due = .false.                  !< at the time asked for last
    type(schedule_t) :: schedule
    type(sample_t), allocatable :: samples(:)
    real(wp), allocatable :: sums(:,:)        !< (most_sums, samples) of this rank
    real(wp), allocatable :: open(:)          !< (samples) part of each that is open to the gas; where walls block it and it counts
  end type monitor_t

  type :: monitors_t
    private
    type(monitor_t), allocatable :: monitors(:)
  contains
    procedure :: create
    procedure :: any_due
    procedure :: measure_gas
    procedure :: measure_parcels
    procedure :: record
  end type monitors_t

contains

  !> Set up the monitors of a case, and their tables.
  subroutine create(self, settings, interval, mesh, series, after, boxes, space)
    class(monitors_t), intent(out) :: self
    type(monitor_settings_t), intent(in) :: settings(:)
    real(wp), intent(in) :: interval                 !< of those that name none; unset: every step [s]
    type(mesh_t), intent(in) :: mesh                 !< of the gas; without gas, its cells are the thickness of regions
    type(series_file_t), intent(inout) :: series
    real(wp), intent(in), optional :: after          !< of a continued run [s]
    type(boxes_t), intent(in), optional :: boxes     !< of the gas
    type(open_space_t), intent(in), optional :: space  !< that walls leave to it

    integer :: i, s
    real(wp) :: own_interval

    allocate (self%monitors(size(settings)))
    do i = 1, size(settings)
      associate (m => self%monitors(i))
        m%place = find_quantity(settings(i)%quantity)
        m%samples = new_samples(mesh, settings(i)%kind, settings(i)%lower, settings(i)%upper)
        m%normal = minloc(settings(i)%upper - settings(i)%lower, dim=1)
        allocate (m%sums(most_sums, size(m%samples)), source=0.0_wp)
        own_interval = merge(settings(i)%interval, interval, is_set(settings(i)%interval))
        m%every_step = .not. is_set(own_interval)
        m%schedule = new_schedule(own_interval, after)
        do s = 1, merge(size(m%samples), 0, quantities(m%place)%of_gas)
          if (quantities(m%place)%is_flux) call weigh_faces(m%samples(s), boxes, mesh)
          if (.not. quantities(m%place)%is_flux) call weigh_cells(m%samples(s), boxes, mesh)
        end do
        if (present(space)) call find_open(m, boxes, mesh, space)
        call add_table(m, settings(i), series)
      end associate
    end do
  end subroutine create

  !> The open parts of the samples of a mean over the gas, or of a volume fraction of the parcels.
  subroutine find_open(monitor, boxes, mesh, space)
    type(monitor_t), intent(inout) :: monitor
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh
    type(open_space_t), intent(in) :: space

    type(sample_t), allocatable :: samples(:)
    integer :: s

    associate (q => quantities(monitor%place))
      if (q%is_flux .or. .not. (q%of_gas .or. q%name == 'solids_volume_fraction')) return
      allocate (samples, source=monitor%samples)
      if (.not. q%of_gas) then
        do s = 1, size(samples)
          samples(s)%lower = samples(s)%low
          samples(s)%upper = samples(s)%high
          call weigh_cells(samples(s), boxes, mesh)
        end do
      end if
    end associate
    monitor%open = boxes%comm%sum([(weighted_sum(samples(s), space%volume), s=1, size(samples))])
  end subroutine find_open

  subroutine add_table(monitor, settings, series)
    type(monitor_t), intent(inout) :: monitor
    type(monitor_settings_t), intent(in) :: settings
    type(series_file_t), intent(inout) :: series

    integer :: i
    real(wp) :: position(3, size(monitor%samples))

    associate (q => quantities(monitor%place))
      call series%add_table('/monitors/'//trim(settings%id), &
                            [column_t(q%name, q%unit, q%meaning, q%components, size(monitor%samples))], monitor%table)
    end associate
    do i = 1, size(monitor%samples)
      position(:, i) = (monitor%samples(i)%lower + monitor%samples(i)%upper)/2
    end do
    call series%annotate(monitor%table, 'kind', text=trim(settings%kind))
    call series%annotate(monitor%table, 'region', unit='m', &
                         numbers=reshape([settings%lower, settings%upper], [3, 2]))
    if (settings%kind == 'line') call series%annotate(monitor%table, 'position', numbers=position, unit='m')
  end subroutine add_table

  !> Whether any monitor wants a value at this time. What is measured next is for those that do.
  function any_due(self, time)
    class(monitors_t), intent(inout) :: self
    real(wp), intent(in) :: time  !< [s]
    logical :: any_due

    integer :: i

    do i = 1, size(self%monitors)
      associate (m => self%monitors(i))
        m%due = m%every_step .or. m%schedule%is_due(time)
        if (m%due) m%sums = 0.0_wp
      end associate
    end do
    any_due = any(self%monitors%due)
  end function any_due

  !> Measure the gas in my box; all fields have two layers of halo.
  subroutine measure_gas(self, pressure, eps, velocity, flux, density, space)
    class(monitors_t), intent(inout) :: self
    real(wp), intent(in) :: pressure(-1:, -1:, -1:)     !< [Pa]
    real(wp), intent(in) :: eps(-1:, -1:, -1:)          !< void fraction [-]
    real(wp), intent(in) :: velocity(-1:, -1:, -1:, :)  !< (face above the cell, component) [m/s]
    real(wp), intent(in) :: flux(-1:, -1:, -1:, :)      !< mass flow through the same faces [kg/s]
    real(wp), intent(in), optional :: density(-1:, -1:, -1:)  !< if it varies [kg/m3]
    type(open_space_t), intent(in), optional :: space   !< as when they were created

    integer :: i, s

    do i = 1, size(self%monitors)
      associate (m => self%monitors(i))
        if (.not. (m%due .and. quantities(m%place)%of_gas)) cycle
        do s = 1, size(m%samples)
          select case (quantities(m%place)%name)
          case ('pressure')
            m%sums(1, s) = weighted_sum(m%samples(s), pressure, space=space)
          case ('void_fraction')
            m%sums(1, s) = weighted_sum(m%samples(s), eps, space=space)
          case ('gas_velocity')
            m%sums(1:3, s) = mean_velocity(m%samples(s), velocity, space=space)
          case ('superficial_velocity')
            m%sums(1:3, s) = mean_velocity(m%samples(s), velocity, eps, space)
          case ('gas_density')
            m%sums(1, s) = weighted_sum(m%samples(s), density, space=space)
          case ('gas_mass_flux')
            m%sums(1, s) = weighted_sum(m%samples(s), flux(:, :, :, m%normal))
          case default
            error stop 'monitors: a quantity of the gas that is not measured'
          end select
        end do
      end associate
    end do
  end subroutine measure_gas

  !> Mean over a sample of the velocity in the cells, times `scale` if it is given.
  pure function mean_velocity(sample, velocity, scale, space) result(mean)
    type(sample_t), intent(in) :: sample
    real(wp), intent(in) :: velocity(-1:, -1:, -1:, :)
    real(wp), intent(in), optional :: scale(-1:, -1:, -1:)
    type(open_space_t), intent(in), optional :: space
    real(wp) :: mean(3)

    integer :: a

    mean = [(weighted_sum(sample, velocity(:, :, :, a), a, scale, space), a=1, 3)]
  end function mean_velocity

  !> Measure my parcels.
  subroutine measure_parcels(self, position, velocity, inverse_mass, diameter, weight)
    class(monitors_t), intent(inout) :: self
    real(wp), intent(in) :: position(:,:), velocity(:,:)  !< (3,n) [m], [m/s]
    real(wp), intent(in) :: inverse_mass(:)               !< of the parcels [1/kg]
    real(wp), intent(in) :: diameter(:), weight(:)        !< of a real particle [m]; particles per parcel

    integer :: i, s, p
    real(wp) :: low(3), high(3)

    do i = 1, size(self%monitors)
      associate (m => self%monitors(i), pieces => size(self%monitors(i)%samples))
        if (quantities(m%place)%of_gas .or. .not. m%due) cycle
        low = m%samples(1)%low
        high = m%samples(pieces)%high
        do p = 1, size(weight)
          if (any(position(:, p) < low .or. position(:, p) >= high)) cycle
          do s = 1, pieces
            if (any(position(:, p) < m%samples(s)%low .or. position(:, p) >= m%samples(s)%high)) cycle
            m%sums(:, s) = m%sums(:, s) + terms(quantities(m%place)%name, m%normal, position(:, p), velocity(:, p), &
                                                [1/inverse_mass(p), diameter(p), weight(p)])
          end do
        end do
      end associate
    end do
  end subroutine measure_parcels

  !> What one parcel adds to the sums from which `value_of` makes a quantity: of a mean, the last but one is the whole.
  function terms(name, normal, x, v, parcel)
    character(len=*), intent(in) :: name
    integer, intent(in) :: normal            !< axis of a flux
    real(wp), intent(in) :: x(3), v(3)       !< position [m] and velocity [m/s]
    real(wp), intent(in) :: parcel(3)        !< mass [kg], diameter of a real particle [m], weight
    real(wp) :: terms(most_sums)

    terms = 0.0_wp
    associate (m => parcel(1), d => parcel(2), w => parcel(3))
      select case (name)
      case ('solids_volume_fraction')
        terms(1) = w*pi/6*d**3
      case ('parcel_velocity')
        terms(1:4) = [m*v, m]
      case ('parcel_count')
        terms(1) = 1.0_wp
      case ('particle_count')
        terms(1) = w
      case ('parcel_mass')
        terms(1) = m
      case ('mean_position')
        terms(1:4) = [m*x, m]
      case ('mean_diameter')
        terms([1, 4]) = w*[d, 1.0_wp]
      case ('sauter_diameter')
        terms([1, 4]) = w*[d**3, d**2]
      case ('kinetic_energy')
        terms(1) = 0.5_wp*m*dot_product(v, v)
      case ('granular_temperature')
        terms = [m*v, m, m*dot_product(v, v)]
      case ('parcel_mass_flux')
        terms(1) = m*v(normal)
      case ('particle_flux')
        terms(1) = w*v(normal)
      case default
        error stop 'monitors: a quantity of parcels that is not measured'
      end select
    end associate
  end function terms

  !> The quantity from the sums of all ranks; "not a number" for a mean over no parcels or nothing open.
  pure function value_of(monitor, s, sums) result(value)
    type(monitor_t), intent(in) :: monitor
    integer, intent(in) :: s                 !< the sample
    real(wp), intent(in) :: sums(most_sums)
    real(wp) :: value(3)

    value = sums(1:3)
    select case (quantities(monitor%place)%name)
    case ('solids_volume_fraction')
      value(1) = sums(1)/product(monitor%samples(s)%high - monitor%samples(s)%low)
    case ('parcel_mass_flux', 'particle_flux')
      value(1) = sums(1)/(monitor%samples(s)%high(monitor%normal) - monitor%samples(s)%low(monitor%normal))
    case ('parcel_velocity', 'mean_position', 'granular_temperature', 'mean_diameter', 'sauter_diameter')
      if (sums(4) <= 0.0_wp) then
        value = ieee_value(1.0_wp, ieee_quiet_nan)
        return
      end if
      value = sums(1:3)/sums(4)
      if (quantities(monitor%place)%name == 'granular_temperature') value(1) = (sums(5)/sums(4) - dot_product(value, value))/3
    case default   ! the sum itself
    end select
    if (.not. allocated(monitor%open)) return
    if (monitor%open(s) > 0.0_wp) then
      value = value/monitor%open(s)
    else
      value = ieee_value(1.0_wp, ieee_quiet_nan)
    end if
  end function value_of

  !> Add up what all ranks measured, and append it to the tables of the monitors that were due.
  subroutine record(self, time, comm, series)
    class(monitors_t), intent(inout) :: self
    real(wp), intent(in) :: time  !< that any_due was asked for [s]
    type(communicator_t), intent(in) :: comm
    type(series_file_t), intent(inout) :: series

    integer :: i, s, from, to, widths(size(self%monitors))
    real(wp), allocatable :: sums(:,:), values(:,:)

    widths = [(merge(size(self%monitors(i)%samples), 0, self%monitors(i)%due), i=1, size(self%monitors))]
    allocate (sums(most_sums, sum(widths)), values(3, maxval([0, widths])))
    to = 0
    do i = 1, size(widths)
      from = to + 1
      to = to + widths(i)
      if (widths(i) > 0) sums(:, from:to) = self%monitors(i)%sums
    end do
    sums = reshape(comm%sum(pack(sums, .true.)), shape(sums))
    from = 0
    do i = 1, size(widths)
      if (widths(i) == 0) cycle
      do s = 1, widths(i)
        values(:, s) = value_of(self%monitors(i), s, sums(:, from + s))
      end do
      associate (m => self%monitors(i))
        call series%append(m%table, time, pack(values(:quantities(m%place)%components, :widths(i)), .true.))
        call m%schedule%done(time)
      end associate
      from = from + widths(i)
    end do
  end subroutine record

end module monitors
