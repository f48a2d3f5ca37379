!> Mistakes that no group shows alone: whether the parts of a case fit together.
module case_checks
  use boundary_settings, only: boundary_settings_t
  use case, only: case_t
  use case_keys, only: keys_t
  use constants, only: is_set
  use contact_checks, only: check_contacts
  use covered_faces, only: faces_covered
  use kinds, only: wp
  use outcome, only: outcome_t
  use parcel_plan, only: parcel_plan_t, new_parcel_plan
  use text, only: brief, shown
  use wall_checks, only: check_walls
  implicit none
  private
  public :: check_case

  real(wp), parameter :: closeness = 1.0e-6_wp      !< of a cell or the domain: what counts as lying on a plane
  real(wp), parameter :: widest = 0.25_wp           !< coupling's width over the longest edge of more than one cell
  real(wp), parameter :: narrowest = 0.5_wp         !< coupling's width over that of parcels wider than a cell
  real(wp), parameter :: fullest = 0.64_wp          !< solids fraction of random close packing of equal spheres

contains

  !> Add to keys%problems; keys that are missing or wrong are passed over here, they are known already.
  subroutine check_case(case, keys)
    type(case_t), intent(in) :: case
    type(keys_t), intent(inout) :: keys

    logical :: domain_known

    call keys%problems%require(case%with_gas .or. case%with_parcels, &
                               keys%file%path//': there is neither &gas nor &parcels: nothing to compute')
    associate (domain => case%domain)
      domain_known = all(is_set([domain%lower, domain%upper]))
      if (domain_known) domain_known = all(domain%upper > domain%lower)
    end associate
    call check_flow(case, keys)
    if (case%with_gas) call check_driving(case, keys)
    if (domain_known .and. is_set(case%coupling%width)) call check_width(case, keys)
    if (case%with_gas .and. is_set(case%run%end_time)) then
      call keys%require_at(case%gas_numerics%time_step <= case%run%end_time, 'run', 1, 'end_time', &
                           'is less than one time_step of &numerics, '//shown(case%gas_numerics%time_step)//' s')
    end if
    if (case%with_parcels) call check_contacts(case, keys)
    if (.not. domain_known) return
    call check_regions(case, keys)
    call check_monitors(case, keys)
    call check_fills(case, keys)
    call check_walls(case, keys)
  end subroutine check_case

  !> Spreading is meant to be local, and takes work that grows with the cells it reaches.
  subroutine check_width(case, keys)
    type(case_t), intent(in) :: case
    type(keys_t), intent(inout) :: keys

    real(wp) :: longest

    associate (domain => case%domain)
      longest = maxval(domain%upper - domain%lower, domain%cells /= 1)
    end associate
    call keys%require_at(case%coupling%width <= widest*longest, 'coupling', 1, 'width', &
                         'is more than a quarter of the domain, '//brief(longest)//' m long')
  end subroutine check_width

  !> A gas of constant density that flows in must flow out, and pressures are above 0 in an ideal one.
  subroutine check_flow(case, keys)
    type(case_t), intent(in) :: case
    type(keys_t), intent(inout) :: keys

    integer :: i

    if (case%gas%density_law == 'ideal') then
      call check_pressures(case, keys)
      return
    end if
    if (any([(case%boundaries(i)%kind == 'outflow', i=1, size(case%boundaries))])) return
    do i = 1, size(case%boundaries)
      if (case%boundaries(i)%kind /= 'inflow') cycle
      call keys%require_at(.false., 'boundary', i, 'kind', 'gas flows in, but no boundary is an outflow')
      return
    end do
  end subroutine check_flow

  !> An ideal gas has no density where its absolute pressure is not above 0.
  subroutine check_pressures(case, keys)
    type(case_t), intent(in) :: case
    type(keys_t), intent(inout) :: keys

    integer :: i

    do i = 1, size(case%boundaries)
      if (.not. is_set(case%boundaries(i)%pressure)) cycle
      associate (absolute => case%gas%reference_pressure + case%boundaries(i)%pressure)
        call keys%require_at(absolute > 0, 'boundary', i, 'pressure', &
                             'of an ideal gas, with reference_pressure of &gas, must be above 0, not '//shown(absolute)//' Pa')
      end associate
    end do
  end subroutine check_pressures

  !> Only a periodic direction is driven by a pressure drop of its own.
  subroutine check_driving(case, keys)
    type(case_t), intent(in) :: case
    type(keys_t), intent(inout) :: keys

    integer :: a

    do a = 1, 3
      if (case%domain%periodic(a)) cycle
      call keys%require_at(.not. abs(case%gas%pressure_drop(a)) > 0, 'gas', 1, 'pressure_drop', 'the domain is not periodic in ' &
                           //'xyz' (a:a)//': give its faces an inflow and an outflow, or pressures')
      call keys%require_at(.not. (case%gas%flow_given .and. abs(case%gas%mass_flow(a)) > 0), 'gas', 1, 'mass_flow', &
                           'the domain is not periodic in '//'xyz' (a:a)//': give its faces an inflow and an outflow')
    end do
    call keys%require_at(any(case%domain%periodic) .or. .not. case%gas%flow_given, 'gas', 1, 'mass_flow', &
                         'is kept along periodic directions, and the domain has none')
  end subroutine check_driving

  !> Every region lies on the surface, and no two on the same part of it.
  subroutine check_regions(case, keys)
    type(case_t), intent(in) :: case
    type(keys_t), intent(inout) :: keys

    integer :: i, j, side, w
    logical :: on(6, size(case%boundaries))

    on = .false.
    do i = 1, size(case%boundaries)
      if (.not. has_box(case%boundaries(i)%lower, case%boundaries(i)%upper)) cycle
      if (case%boundaries(i)%surface == 'walls') then
        call keys%require_at(any([(case%walls(w)%blocks_gas(), w=1, size(case%walls))]), 'boundary', i, 'surface', &
                             'no &wall blocks the gas: give one a gas_side')
        cycle
      end if
      on(:, i) = [(is_on_side(case, case%boundaries(i), side), side=1, 6)]
      call keys%require_at(any(on(:, i)), 'boundary', i, '', 'touches no face of the domain, or not the middle of a cell''s')
      call keys%require_at(.not. any(on(:, i)) .or. any(on(:, i) .and. .not. [case%domain%periodic, case%domain%periodic]), &
                           'boundary', i, '', 'lies on a periodic face')
      call check_moving_wall(case, i, on(:, i), keys)
      call check_profile(case, i, keys)
      if (case%boundaries(i)%material > 0) then
        call keys%require_at(any(faces_covered(case%domain, case%boundaries(i))), 'boundary', i, 'material', &
                             'parcels know whole faces of the domain only, and it covers none')
      end if
      do j = 1, i - 1
        call keys%require_at(.not. any([(overlap(case, i, j, side), side=1, 6)] .and. on(:, i) .and. on(:, j)), &
                             'boundary', i, '', 'overlaps &boundary('//trim(case%boundaries(j)%id)//')')
      end do
    end do
  end subroutine check_regions

  !> A wall of the gas moves along itself, and where there are parcels they feel walls of their own.
  subroutine check_moving_wall(case, i, on, keys)
    type(case_t), intent(in) :: case
    integer, intent(in) :: i
    logical, intent(in) :: on(6)  !< the sides it lies on
    type(keys_t), intent(inout) :: keys

    associate (velocity => case%boundaries(i)%wall_velocity)
      if (.not. any(abs(velocity) > 0)) return
      call keys%require_at(.not. any(on .and. abs([velocity, velocity]) > 0), 'boundary', i, 'wall_velocity', &
                           'must be along the wall, which may not move through the domain')
    end associate
    call keys%require_at(.not. case%with_parcels, 'boundary', i, 'wall_velocity', &
                         'moves the gas only, and parcels would feel a wall at rest: not possible with &parcels')
  end subroutine check_moving_wall

  !> The table of an inflow is over directions in which its region has an extent, and covers it.
  subroutine check_profile(case, i, keys)
    type(case_t), intent(in) :: case
    integer, intent(in) :: i
    type(keys_t), intent(inout) :: keys

    real(wp) :: lower(3), upper(3), near(3)
    character(len=:), allocatable :: words
    logical :: covered
    integer :: m

    associate (region => case%boundaries(i), domain => case%domain)
      near = closeness*(domain%upper - domain%lower)
      lower = max(region%lower, domain%lower)
      upper = min(region%upper, domain%upper)
      do m = 1, region%table%n_axes
        associate (a => region%table%axes(m))
          if (upper(a) - lower(a) > near(a)) cycle
          call keys%require_at(.false., 'boundary', i, 'file', 'is over '//'xyz'(a:a)//', in which the region has no extent')
          return
        end associate
      end do
      if (region%table%n_axes == 0) return
      call region%table%covers(lower, upper, near, covered, words)
      call keys%require_at(covered, 'boundary', i, 'file', 'does not cover the region: '//words)
    end associate
  end subroutine check_profile

  !> Whether a region has an area on a side: 1 to 3 the low x, y, z, 4 to 6 the high ones. With a grid, the
  !> middle of a cell's face must be in it.
  pure function is_on_side(case, region, side) result(on)
    type(case_t), intent(in) :: case
    type(boundary_settings_t), intent(in) :: region
    integer, intent(in) :: side
    logical :: on

    integer :: a, b
    real(wp) :: plane, near, first

    a = merge(side, side - 3, side <= 3)
    associate (domain => case%domain)
      plane = merge(domain%lower(a), domain%upper(a), side <= 3)
      near = closeness*(domain%upper(a) - domain%lower(a))/max(1, domain%cells(a))
      on = region%lower(a) <= plane + near .and. region%upper(a) >= plane - near
      do b = 1, 3
        if (b == a) cycle
        on = on .and. min(region%upper(b), domain%upper(b)) > max(region%lower(b), domain%lower(b))
        if (domain%axis(b)%n == 0 .or. .not. on) cycle
        first = domain%axis(b)%in_metres(max(0, ceiling(domain%axis(b)%in_cells(region%lower(b)) - 0.5_wp)) + 0.5_wp)
        on = on .and. first <= min(region%upper(b), domain%upper(b))
      end do
    end associate
  end function is_on_side

  !> Whether two regions, both on a side, share an area of it.
  pure function overlap(case, i, j, side)
    type(case_t), intent(in) :: case
    integer, intent(in) :: i, j, side
    logical :: overlap

    integer :: a, b

    a = merge(side, side - 3, side <= 3)
    overlap = has_box(case%boundaries(j)%lower, case%boundaries(j)%upper)
    do b = 1, 3
      if (b == a .or. .not. overlap) cycle
      overlap = min(case%boundaries(i)%upper(b), case%boundaries(j)%upper(b)) &
                - max(case%boundaries(i)%lower(b), case%boundaries(j)%lower(b)) &
                > closeness*(case%domain%upper(b) - case%domain%lower(b))
    end do
  end function overlap

  subroutine check_monitors(case, keys)
    type(case_t), intent(in) :: case
    type(keys_t), intent(inout) :: keys

    integer :: i

    do i = 1, size(case%monitors)
      call keys%require_at(case%monitors(i)%quantity /= 'gas_density' .or. case%gas%density_law == 'ideal', 'monitor', i, &
                           'quantity', 'is the same everywhere: density of &gas')
      if (.not. has_box(case%monitors(i)%lower, case%monitors(i)%upper)) cycle
      call keys%require_at(is_inside(case, case%monitors(i)%lower, case%monitors(i)%upper), 'monitor', i, '', &
                           'reaches out of the domain')
    end do
  end subroutine check_monitors

  subroutine check_fills(case, keys)
    type(case_t), intent(in) :: case
    type(keys_t), intent(inout) :: keys

    type(parcel_plan_t) :: plans(size(case%fills))
    integer :: i

    do i = 1, size(case%fills)
      associate (fill => case%fills(i))
        if (has_box(fill%lower, fill%upper)) call keys%require_at(is_inside(case, fill%lower, fill%upper), 'fill', i, '', &
                                                                  'reaches out of the domain')
      end associate
      call make_plan(case, i, plans(i), keys)
      if (plans(i)%known) call check_sizes(case, i, plans(i), keys)
    end do
    do i = 1, size(case%fills)
      if (plans(i)%known) call check_room(case, i, plans, keys)
    end do
  end subroutine check_fills

  subroutine make_plan(case, i, plan, keys)
    type(case_t), intent(in) :: case
    integer, intent(in) :: i
    type(parcel_plan_t), intent(out) :: plan
    type(keys_t), intent(inout) :: keys

    type(outcome_t) :: outcome
    integer :: known

    known = keys%problems%count()
    call new_parcel_plan(case, i, plan, outcome)
    ! What made it fail is most often a key that has been told of already.
    if (outcome%failed() .and. known == 0) call keys%require_at(.false., 'powder', case%fills(i)%powder, '', outcome%message)
  end subroutine make_plan

  !> Parcels must fit into the domain, their box and a gas cell, and stand for at least one particle.
  subroutine check_sizes(case, i, plan, keys)
    type(case_t), intent(in) :: case
    integer, intent(in) :: i
    type(parcel_plan_t), intent(in) :: plan
    type(keys_t), intent(inout) :: keys

    real(wp) :: largest, width(3)
    character(len=:), allocatable :: key, size_text

    key = 'weighting'
    if (case%parcels%weighting == 'ssp') key = 'diameter'
    if (case%parcels%weighting == 'ssw') key = 'weight'
    largest = plan%diameter(2)
    size_text = brief(largest)//' m wide'
    width = case%domain%upper - case%domain%lower
    call keys%require_at(plan%mean_weight > 1 - closeness, 'parcels', 1, key, &
                         'parcels of &fill('//trim(case%fills(i)%id)//') hold less than one particle, ' &
                         //brief(plan%mean_weight)//' on average')
    call keys%require_at(all(largest <= width), 'parcels', 1, key, &
                         'parcels are up to '//size_text//', wider than the domain: '//brief(minval(width))//' m')
    if (any(largest > width)) return
    associate (fill => case%fills(i))
      if (has_box(fill%lower, fill%upper)) call keys%require_at(all(largest <= fill%upper - fill%lower), 'fill', i, '', &
                                                                'its parcels are up to '//size_text//', wider than the box')
    end associate
    call check_cells(case, i, largest, keys)
  end subroutine check_sizes

  !> Parcels wider than a cell must be spread over several, or single cells would be full of one.
  subroutine check_cells(case, i, largest, keys)
    type(case_t), intent(in) :: case
    integer, intent(in) :: i
    real(wp), intent(in) :: largest  !< parcel [m]
    type(keys_t), intent(inout) :: keys

    real(wp) :: cell
    character(len=:), allocatable :: parcels

    if (any(case%domain%axis%n == 0)) return
    cell = minval(case%domain%axis%finest)
    if (largest <= cell*(1 + closeness)) return
    parcels = 'parcels of &fill('//trim(case%fills(i)%id)//') are up to '//brief(largest)//' m wide, wider than a cell: ' &
      //brief(cell)//' m'
    if (is_set(case%coupling%width)) then
      call keys%require_at(case%coupling%width >= narrowest*largest*(1 - closeness), 'coupling', 1, 'width', &
                           parcels//', and must be spread by '//brief(narrowest*largest)//' m or more')
    else
      call keys%require_at(.false., 'grid', 1, 'cells', parcels//'; &coupling width = '//brief(narrowest*largest) &
                           //' m or more would spread them')
    end if
  end subroutine check_cells

  !> A box, with the other fills that lie in it, is not fuller than spheres can be packed.
  subroutine check_room(case, i, plans, keys)
    type(case_t), intent(in) :: case
    integer, intent(in) :: i
    type(parcel_plan_t), intent(in) :: plans(:)
    type(keys_t), intent(inout) :: keys

    real(wp) :: fraction
    character(len=:), allocatable :: key
    logical :: inside(size(plans))
    integer :: j

    associate (box => case%fills(i))
      if (.not. has_box(box%lower, box%upper)) return
      inside = [(all(case%fills(j)%lower >= box%lower) .and. all(case%fills(j)%upper <= box%upper) .and. plans(j)%known, &
                 j=1, size(plans))]
      fraction = sum(plans%volume, mask=inside)/product(box%upper - box%lower)
      key = 'number'
      if (is_set(box%mass)) key = 'mass'
    end associate
    call keys%require_at(fraction <= fullest, 'fill', i, key, 'does not fit: solids would fill '//brief(fraction) &
                         //' of the box, and at most '//shown(fullest)//' can be packed')
  end subroutine check_room

  pure function has_box(lower, upper)
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    logical :: has_box

    has_box = all(is_set(lower)) .and. all(is_set(upper))
    if (has_box) has_box = all(upper >= lower)
  end function has_box

  pure function is_inside(case, lower, upper) result(inside)
    type(case_t), intent(in) :: case
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    logical :: inside

    real(wp) :: near(3)

    near = closeness*(case%domain%upper - case%domain%lower)
    inside = all(lower >= case%domain%lower - near) .and. all(upper <= case%domain%upper + near)
  end function is_inside

end module case_checks
