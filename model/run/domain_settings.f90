!> The &domain and &grid groups: the box everything happens in, and its gas cells.
module domain_settings
  use case_keys, only: keys_t
  use constants, only: unset, is_set
  use grid_axis, only: axis_t, uniform_axis, graded_axis, graded_faces
  use kinds, only: wp
  use text, only: brief, shown
  implicit none
  private
  public :: domain_settings_t, declare_domain, declare_grid

  type :: domain_settings_t
    real(wp) :: lower(3) = unset                          !< lowest corner [m]
    real(wp) :: upper(3) = unset                          !< highest corner [m]
    real(wp) :: gravity(3) = [0.0_wp, -9.81_wp, 0.0_wp]   !< acceleration [m/s2]
    logical :: periodic(3) = .false.                      !< whether opposite faces are joined
    integer :: cells(3) = 0                               !< gas cells; 0 where there is no grid
    type(axis_t) :: axis(3)                               !< where their faces are, once both groups are right
  end type domain_settings_t

  real(wp), parameter :: steepest = 1.5_wp  !< most that two cells beside each other may differ in width [-]
  character(len=*), parameter :: axis_names = 'xyz'

  !> How the faces of one axis are graded, as given.
  type :: grading_t
    real(wp), allocatable :: breaks(:)  !< between segments [m]
    real(wp), allocatable :: cells(:)   !< of each segment
    real(wp), allocatable :: ratios(:)  !< last width of a segment over its first [-]
  end type grading_t

contains

  !> The keys of the open group &domain.
  subroutine declare_domain(settings, keys)
    type(domain_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%get('lower', settings%lower, 'lowest corner of the domain [m]', required=.true., when='always')
    call keys%get('upper', settings%upper, 'highest corner of the domain [m]', required=.true., when='always')
    call keys%get('gravity', settings%gravity, 'acceleration of gravity [m/s2]')
    call keys%get('periodic', settings%periodic, 'whether the faces normal to x, y, z are joined')
    if (.not. all(is_set([settings%lower, settings%upper]))) return
    call keys%require(all(settings%upper > settings%lower), 'upper', 'must be above lower in x, y and z')
  end subroutine declare_domain

  !> The keys of the open group &grid.
  subroutine declare_grid(settings, keys)
    type(domain_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    type(grading_t) :: grading
    integer :: a
    logical :: domain_is_right

    call keys%get('cells', settings%cells, 'gas cells in x, y, z; one cell across is two-dimensional', '[1, 100000]', &
                  required=.true., when='always')
    domain_is_right = all(is_set([settings%lower, settings%upper]))
    if (domain_is_right) domain_is_right = all(settings%upper > settings%lower)
    do a = 1, 3
      call declare_grading(grading, axis_names(a:a), keys)
      if (.not. domain_is_right .or. any(settings%cells < 1)) cycle
      if (.not. keys%given(axis_names(a:a)//'_cells')) then
        settings%axis(a) = uniform_axis(settings%lower(a), settings%upper(a), settings%cells(a), settings%periodic(a))
      else if (allocated(grading%cells) .and. allocated(grading%ratios)) then
        call grade(settings, a, grading, keys)
      end if
    end do
  end subroutine declare_grid

  subroutine declare_grading(grading, name, keys)
    type(grading_t), intent(out) :: grading
    character(len=*), intent(in) :: name  !< of the axis
    type(keys_t), intent(inout) :: keys

    call keys%get_list(name//'_cells', grading%cells, 'cells of each segment of a graded axis '//name//'; together `cells`', &
                       '[1, 100000]')
    call keys%get_list(name//'_breaks', grading%breaks, 'where one segment ends and the next begins, rising [m]')
    call keys%get_list(name//'_ratios', grading%ratios, 'width of the last cell of each segment over that of its first, '// &
                       'the widths between growing by a constant factor [-]', '[0.001, 1000]', &
                       required=keys%given(name//'_cells'), when='with '//name//'_cells')
    call keys%require(keys%given(name//'_cells') .or. .not. keys%given(name//'_ratios'), name//'_ratios', &
                      'is for an axis with '//name//'_cells')
    call keys%require(keys%given(name//'_cells') .or. .not. keys%given(name//'_breaks'), name//'_breaks', &
                      'is for an axis with '//name//'_cells')
  end subroutine declare_grading

  !> Make the faces of a graded axis, if what is given fits together.
  subroutine grade(settings, a, grading, keys)
    type(domain_settings_t), intent(inout) :: settings
    integer, intent(in) :: a
    type(grading_t), intent(inout) :: grading
    type(keys_t), intent(inout) :: keys

    real(wp), allocatable :: ends(:)
    integer :: m, i
    logical :: fits
    character(len=1) :: name

    name = axis_names(a:a)
    m = size(grading%cells)
    if (.not. allocated(grading%breaks)) allocate (grading%breaks(0))
    allocate (ends, source=[settings%lower(a), grading%breaks, settings%upper(a)])
    fits = .true.
    call demand(size(grading%ratios) == m, '_ratios', 'there must be as many as '//name//'_cells: '//shown(m))
    call demand(size(ends) == m + 1, '_breaks', 'there must be one fewer than '//name//'_cells: '//shown(m - 1))
    call demand(all(ends(2:) > ends(:size(ends) - 1)), '_breaks', 'must rise within the domain')
    call demand(all(abs(grading%cells - nint(grading%cells)) <= 0.0_wp), '_cells', 'must be whole numbers')
    call demand(sum(nint(grading%cells)) == settings%cells(a), '_cells', 'must add up to the cells of this axis: ' &
                //shown(settings%cells(a))//', not '//shown(sum(nint(grading%cells))))
    if (.not. fits) return
    associate (axis => settings%axis(a))
      axis = graded_axis(graded_faces(ends, nint(grading%cells), grading%ratios), settings%periodic(a))
      i = steepest_step(axis)
      call demand(max(axis%width(i), axis%width(i + 1)) <= steepest*min(axis%width(i), axis%width(i + 1)), '_ratios', &
                  'cells '//shown(i)//' and '//shown(i + 1)//' are '//brief(axis%width(i))//' and '//brief(axis%width(i + 1)) &
                  //' m wide: a cell may be at most '//shown(steepest)//' times as wide as the one beside it')
    end associate

  contains

    subroutine demand(holds, key, what)
      logical, intent(in) :: holds
      character(len=*), intent(in) :: key, what

      if (.not. holds) fits = .false.
      call keys%require(holds, name//key, what)
    end subroutine demand

  end subroutine grade

  !> The cell which differs most from the one above it.
  pure function steepest_step(axis) result(i)
    type(axis_t), intent(in) :: axis
    integer :: i

    associate (width => axis%width(1:axis%n), next => axis%width(2:axis%n + 1))
      i = maxloc(max(width/next, next/width), dim=1)
    end associate
  end function steepest_step

end module domain_settings
