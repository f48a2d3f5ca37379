!> A &boundary record: a named part of the domain's surface, or of the walls within it, and what happens there.
module boundary_settings
  use case_keys, only: keys_t
  use constants, only: unset, is_set
  use files, only: exists
  use inflow_profile, only: inflow_profile_t, read_inflow_profile
  use kinds, only: wp
  use problems, only: problems_t
  use text, only: line_length, word_length, shown
  implicit none
  private
  public :: boundary_settings_t, declare_boundary

  real(wp), parameter :: closeness = 1.0e-6_wp  !< of a cell's edge: what counts as lying on a plane

  !> The part of the domain's surface inside the box lower..upper. Faces no record names are no-slip walls.
  type :: boundary_settings_t
    character(len=word_length) :: id = ''
    character(len=word_length) :: surface = 'domain'  !< 'domain' | 'walls': within the domain, that block the gas
    real(wp) :: lower(3) = unset                     !< lowest corner of the box [m]
    real(wp) :: upper(3) = unset                     !< highest corner of the box [m]
    character(len=word_length) :: kind = ''          !< 'inflow' | 'outflow' | 'no_slip' | 'slip'
    real(wp) :: velocity = unset                     !< inflow: superficial, into the domain [m/s]
    real(wp) :: mass_flow = unset                    !< inflow, instead of velocity: over the region [kg/s]
    real(wp) :: volume_flow = unset                  !< inflow, instead of velocity: over the region [m3/s]
    character(len=word_length) :: profile = 'uniform'  !< inflow: 'uniform' | 'parabola' | 'table' over the region
    character(len=line_length) :: file = ''          !< inflow by a table: .csv
    type(inflow_profile_t) :: table                  !< what it holds
    real(wp), allocatable :: times(:)                !< inflow that changes: when it has the factors [s]
    real(wp), allocatable :: factors(:)              !< by which the inflow is multiplied then [-]
    real(wp) :: wall_velocity(3) = 0.0_wp            !< no_slip: of the wall, along itself [m/s]
    real(wp) :: pressure = unset                     !< outflow [Pa]; unset: that of the gas
    character(len=word_length) :: parcels = 'wall'   !< 'wall': parcels bounce | 'open': they leave
    character(len=word_length) :: material_id = ''   !< key material: of the wall
    integer :: material = 0                          !< place of that record; 0: that of all walls
  contains
    procedure :: holds
  end type boundary_settings_t

contains

  !> Whether a point is in the box, or as good as on its surface.
  pure function holds(self, x, h)
    class(boundary_settings_t), intent(in) :: self
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp), intent(in) :: h(3)  !< edges of a cell [m]
    logical :: holds

    holds = all(x >= self%lower - closeness*h .and. x <= self%upper + closeness*h)
  end function holds

  !> The keys of the open record.
  subroutine declare_boundary(settings, keys)
    type(boundary_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%get_id(settings%id, 'name of the region')
    call keys%get('surface', settings%surface, 'that of the domain, or of the walls within it that block the gas, in cells '// &
                  'whose middle the box holds', 'domain | walls')
    call keys%get('lower', settings%lower, 'lowest corner of a box: the region is the part of the surface inside [m]', &
                  required=.true., when='always')
    call keys%get('upper', settings%upper, 'highest corner of the box [m]', required=.true., when='always')
    call keys%get('kind', settings%kind, 'what the gas does there; no_slip where no region is', &
                  'inflow | outflow | no_slip | slip', required=keys%has_group('gas'), when='with &gas')
    call keys%get('velocity', settings%velocity, 'inflow: superficial velocity into the domain [m/s]', '[0, inf)')
    call keys%get('mass_flow', settings%mass_flow, 'inflow, instead of velocity: mass flow over the region [kg/s]', '[0, inf)')
    call keys%get('volume_flow', settings%volume_flow, 'inflow, instead of velocity: volume flow over the region [m3/s]', &
                  '[0, inf)')
    call keys%get('profile', settings%profile, 'inflow: the same everywhere, a parabola in each direction along the region '// &
                  'that has several cells and is not periodic, or as in file', 'uniform | parabola | table')
    call keys%get_path('file', settings%file, 'inflow by a table, .csv: columns velocity in m/s and one or two of x, y, z in '// &
                       'm, linear between; velocity, mass_flow or volume_flow need not be given: if one is, the table is '// &
                       'multiplied to have it', must_exist=.true.)
    call keys%get_list('times', settings%times, 'inflow that changes: when it is factors times what is given, linear between, '// &
                       'constant before and after; a time given twice is a jump [s]')
    call keys%get_list('factors', settings%factors, 'inflow that changes: as many as times [-]', '[0, inf)')
    call keys%get('wall_velocity', settings%wall_velocity, 'no_slip: velocity of the wall, along itself [m/s]')
    call keys%get('pressure', settings%pressure, 'outflow: pressure there; that of &gas if not given [Pa]')
    call keys%get('parcels', settings%parcels, 'whether parcels bounce off the region or leave through it', 'wall | open')
    call keys%get_optional_reference('material', settings%material_id, settings%material, 'material', &
                                     'of a whole face: what it is made of, a &material; wall_material of &contact if not given')
    call check_boundary(settings, keys)
    if (settings%profile == 'table') call read_table(settings, keys)
  end subroutine declare_boundary

  !> The table of an inflow; that there is no such file is known already.
  subroutine read_table(settings, keys)
    type(boundary_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    type(problems_t) :: problems
    integer :: i

    if (len_trim(settings%file) == 0) return
    if (.not. exists(trim(settings%file))) return
    call read_inflow_profile(trim(settings%file), settings%table, problems)
    do i = 1, problems%count()
      call keys%problems%add(problems%message(i))
    end do
    if (problems%count() > 0) settings%table%n_axes = 0
  end subroutine read_table

  !> Each kind has its own keys.
  subroutine check_boundary(settings, keys)
    type(boundary_settings_t), intent(in) :: settings
    type(keys_t), intent(inout) :: keys

    character(len=*), parameter :: of_inflows(5) = [character(len=11) :: 'velocity', 'mass_flow', 'volume_flow', 'times', 'factors']
    integer :: speeds, i

    if (all(is_set([settings%lower, settings%upper]))) then
      call keys%require(all(settings%upper >= settings%lower), 'upper', 'must not be below lower in x, y or z')
    end if
    call keys%require(settings%parcels /= 'open' .or. .not. keys%given('material'), 'material', &
                      'parcels leave there and touch nothing')
    if (len_trim(settings%kind) == 0) return
    if (settings%surface == 'walls') call check_walls(settings, keys)
    speeds = count([keys%given('velocity'), keys%given('mass_flow'), keys%given('volume_flow')])
    if (settings%kind == 'inflow') then
      call keys%require(speeds == 1 .or. (settings%profile == 'table' .and. speeds == 0), 'kind', &
                        'give one of velocity, mass_flow and volume_flow')
      call keys%require(settings%profile == 'table' .eqv. keys%given('file'), 'profile', &
                        'a table and its file go together: give both or neither')
      call check_table(settings, keys)
    else
      do i = 1, size(of_inflows)
        call keys%require(.not. keys%given(trim(of_inflows(i))), trim(of_inflows(i)), 'belongs to an inflow')
      end do
      call keys%require(settings%profile == 'uniform', 'profile', 'belongs to an inflow')
      call keys%require(.not. keys%given('file'), 'file', 'belongs to an inflow')
    end if
    call keys%require(settings%kind == 'no_slip' .or. .not. any(abs(settings%wall_velocity) > 0.0_wp), 'wall_velocity', &
                      'belongs to a no_slip wall')
    call keys%require(settings%kind == 'outflow' .or. .not. keys%given('pressure'), 'pressure', 'belongs to an outflow')
  end subroutine check_boundary

  !> Walls within the domain stop parcels and have their motion and their material from &wall.
  subroutine check_walls(settings, keys)
    type(boundary_settings_t), intent(in) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%require(settings%profile == 'uniform', 'profile', 'of the walls within the domain is uniform')
    call keys%require(.not. keys%given('wall_velocity'), 'wall_velocity', 'of a wall within the domain is given in &wall')
    call keys%require(settings%parcels == 'wall', 'parcels', 'do not leave through the walls within the domain')
    call keys%require(.not. keys%given('material'), 'material', 'of a wall within the domain is given in &wall')
  end subroutine check_walls

  !> An inflow that changes has as many factors as times.
  subroutine check_table(settings, keys)
    type(boundary_settings_t), intent(in) :: settings
    type(keys_t), intent(inout) :: keys

    integer :: n

    call keys%require(keys%given('factors') .or. .not. keys%given('times'), 'times', 'need as many factors')
    call keys%require(keys%given('times') .or. .not. keys%given('factors'), 'factors', 'need as many times')
    if (.not. (allocated(settings%times) .and. allocated(settings%factors))) return
    n = size(settings%times)
    call keys%require(n == size(settings%factors), 'factors', &
                      'there must be as many as times: '//shown(n)//', not '//shown(size(settings%factors)))
    call keys%require(all(settings%times(2:) >= settings%times(:n - 1)), 'times', 'must not fall')
  end subroutine check_table

end module boundary_settings
