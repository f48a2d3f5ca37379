!> The &domain and &grid groups: the box everything happens in, and its gas cells.
module domain_settings
  use case_keys, only: keys_t
  use constants, only: unset, is_set
  use kinds, only: wp
  implicit none
  private
  public :: domain_settings_t, declare_domain, declare_grid

  type :: domain_settings_t
    real(wp) :: lower(3) = unset                          !< lowest corner [m]
    real(wp) :: upper(3) = unset                          !< highest corner [m]
    real(wp) :: gravity(3) = [0.0_wp, -9.81_wp, 0.0_wp]   !< acceleration [m/s2]
    logical :: periodic(3) = .false.                      !< whether opposite faces are joined
    integer :: cells(3) = 0                               !< gas cells; 0 where there is no grid
  end type domain_settings_t

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

  !> The key of the open group &grid.
  subroutine declare_grid(settings, keys)
    type(domain_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%get('cells', settings%cells, 'gas cells in x, y, z; one cell across is two-dimensional', '[1, 100000]', &
                  required=.true., when='always')
  end subroutine declare_grid

end module domain_settings
