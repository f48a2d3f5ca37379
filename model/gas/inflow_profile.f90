!> The velocity of an inflow as a table over space: at places along one coordinate, linear between them, or on a lattice in two,
!> bilinear.
!>
!> A face of a cell takes the mean over itself, so that what flows in through faces that cover the table is its integral.
module inflow_profile
  use csv_file, only: read_csv
  use kinds, only: wp
  use problems, only: problems_t
  use sorting, only: ascending
  use text, only: brief, shown
  implicit none
  private
  public :: inflow_profile_t, read_inflow_profile, new_inflow_profile

  character(len=8), parameter :: columns(4) = ['x       ', 'y       ', 'z       ', 'velocity']

  type :: inflow_profile_t
    integer :: n_axes = 0                    !< 1 or 2; 0: there is no table
    integer :: axes(2) = 0                   !< the coordinates its places are along
    real(wp), allocatable :: first(:)        !< places along axes(1), rising [m]
    real(wp), allocatable :: second(:)       !< along axes(2); one, of no meaning, without
    real(wp), allocatable :: velocity(:,:)   !< (first,second), into the domain [m/s]
  contains
    procedure :: mean_over
    procedure :: covers
  end type inflow_profile_t

contains

  !> A table from a file with the columns velocity and one or two of x, y and z, in the latter case a row for each point of a
  !> lattice, in any order. What is wrong with it is noted.
  subroutine read_inflow_profile(path, profile, problems)
    character(len=*), intent(in) :: path
    type(inflow_profile_t), intent(out) :: profile
    type(problems_t), intent(inout) :: problems

    logical :: given(4)
    real(wp), allocatable :: values(:,:)
    integer, allocatable :: line(:), axes(:)
    integer :: row
    type(problems_t) :: found

    call read_csv(path, columns, given, values, line, found)
    axes = pack([1, 2, 3], given(1:3))
    if (found%count() == 0) then
      call found%require(given(4) .and. any(size(axes) == [1, 2]), path//': must have the column velocity and one or two of ' &
                         //'x, y and z')
      do row = 1, size(line)
        call found%require(.not. values(4, row) < 0.0_wp, path//':'//shown(line(row))//': velocity = '//shown(values(4, row)) &
                           //': must be at least 0')
      end do
    end if
    if (found%count() == 0 .and. size(axes) == 1) then
      do row = 2, size(line)
        call found%require(values(axes(1), row) > values(axes(1), row - 1), path//':'//shown(line(row))//': ' &
                           //trim(columns(axes(1)))//' = '//shown(values(axes(1), row))//': must rise from row to row')
      end do
    end if
    if (found%count() == 0) call new_inflow_profile(axes, values(axes, :), values(4, :), profile, path, found)
    do row = 1, found%count()
      call problems%add(found%message(row))
    end do
  end subroutine read_inflow_profile

  !> A table from its points.
  subroutine new_inflow_profile(axes, places, velocity, profile, name, problems)
    integer, intent(in) :: axes(:)        !< the coordinates
    real(wp), intent(in) :: places(:,:)   !< (axes,points) [m]
    real(wp), intent(in) :: velocity(:)   !< (points) [m/s]
    type(inflow_profile_t), intent(out) :: profile
    character(len=*), intent(in) :: name  !< for what is wrong with it
    type(problems_t), intent(inout) :: problems

    integer, allocatable :: rows(:,:)  !< how many points are at each place of the lattice
    integer :: p, i, j

    profile%n_axes = size(axes)
    profile%axes(:size(axes)) = axes
    profile%first = unlike(places(1, :))
    profile%second = [0.0_wp]
    if (size(axes) == 2) profile%second = unlike(places(2, :))
    allocate (profile%velocity(size(profile%first), size(profile%second)), source=0.0_wp)
    allocate (rows(size(profile%first), size(profile%second)), source=0)
    do p = 1, size(velocity)
      i = count(profile%first <= places(1, p))
      j = 1
      if (size(axes) == 2) j = count(profile%second <= places(2, p))
      profile%velocity(i, j) = velocity(p)
      rows(i, j) = rows(i, j) + 1
    end do
    call problems%require(size(profile%first) > 1 .and. (size(axes) == 1 .or. size(profile%second) > 1), &
                          name//': must have two places or more along each of its coordinates')
    call problems%require(all(rows == 1), name//': is no lattice: it has '//shown(size(velocity))//' rows, with ' &
                          //shown(size(profile%first))//' different '//trim(columns(axes(1)))//' and ' &
                          //shown(size(profile%second))//' different '//trim(columns(axes(size(axes)))) &
                          //', and each pair must stand once')
    call problems%require(any(velocity > 0.0_wp), name//': lets nothing in: all velocities are 0')
  end subroutine new_inflow_profile

  !> The different ones among some numbers, in ascending order.
  pure function unlike(x) result(different)
    real(wp), intent(in) :: x(:)
    real(wp), allocatable :: different(:)

    real(wp) :: sorted(size(x))
    integer :: m

    sorted = x(ascending(x))
    different = pack(sorted, [(m == 1 .or. sorted(m) > sorted(max(1, m - 1)), m=1, size(x))])
  end function unlike

  !> Whether the table reaches from corner to corner of a box, along its coordinates; how far it does, in words.
  pure subroutine covers(self, lower, upper, near, holds, words)
    class(inflow_profile_t), intent(in) :: self
    real(wp), intent(in) :: lower(3), upper(3)  !< [m]
    real(wp), intent(in) :: near(3)             !< by which it may fall short [m]
    logical, intent(out) :: holds
    character(len=:), allocatable, intent(out) :: words

    real(wp), allocatable :: places(:)
    integer :: m, a

    holds = .true.
    words = ''
    do m = 1, self%n_axes
      a = self%axes(m)
      allocate (places, source=self%first)
      if (m == 2) places = self%second
      if (places(1) > lower(a) + near(a) .or. places(size(places)) < upper(a) - near(a)) then
        holds = .false.
        words = trim(columns(a))//' goes from '//brief(places(1))//' to '//brief(places(size(places)))//' m, the region from ' &
          //brief(lower(a))//' to '//brief(upper(a))//' m'
        return
      end if
      deallocate (places)
    end do
  end subroutine covers

  !> Mean of the velocity over a box, flat or not; beyond the table it is as at its edge [m/s].
  pure function mean_over(self, lower, upper) result(mean)
    class(inflow_profile_t), intent(in) :: self
    real(wp), intent(in) :: lower(3), upper(3)  !< corners [m]
    real(wp) :: mean

    real(wp) :: second(size(self%second))

    second = 1.0_wp
    if (self%n_axes == 2) second = weights(self%second, lower(self%axes(2)), upper(self%axes(2)))
    mean = dot_product(matmul(weights(self%first, lower(self%axes(1)), upper(self%axes(1))), self%velocity), second)
  end function mean_over

  !> By how much each place counts in the mean from one point to another of what is linear between places.
  pure function weights(places, from, to)
    real(wp), intent(in) :: places(:), from, to  !< [m]
    real(wp) :: weights(size(places))

    real(wp) :: low, high, share
    integer :: m, n

    n = size(places)
    weights = 0.0_wp
    weights(1) = max(0.0_wp, min(to, places(1)) - from)
    weights(n) = max(0.0_wp, to - max(from, places(n)))
    do m = 1, n - 1
      low = max(from, places(m))
      high = min(to, places(m + 1))
      if (high <= low) cycle
      share = (0.5_wp*(low + high) - places(m))/(places(m + 1) - places(m))
      weights(m) = weights(m) + (1 - share)*(high - low)
      weights(m + 1) = weights(m + 1) + share*(high - low)
    end do
    weights = weights/(to - from)
  end function weights

end module inflow_profile
