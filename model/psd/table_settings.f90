!> A &table record: sizes and what share of a powder they have.
module table_settings
  use case_keys, only: keys_t
  use kinds, only: wp
  use text, only: word_length, shown
  implicit none
  private
  public :: table_settings_t, declare_table

  type :: table_settings_t
    character(len=word_length) :: id = ''
    real(wp), allocatable :: sizes(:)       !< [m]
    real(wp), allocatable :: fractions(:)   !< see powder_settings_t [-]
  end type table_settings_t

contains

  !> The keys of the open record.
  subroutine declare_table(settings, keys)
    type(table_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    integer :: n

    call keys%get_id(settings%id, 'name of the table')
    call keys%get_list('sizes', settings%sizes, 'diameters, rising [m]', '(0, 1)', required=.true., when='always')
    call keys%get_list('fractions', settings%fractions, 'sieve_table: mass fraction finer than each size, from 0 to 1; '// &
                       'number_table: share of the particles of each size, together 1 [-]', '[0, 1]', &
                       required=.true., when='always')
    if (.not. (allocated(settings%sizes) .and. allocated(settings%fractions))) return
    n = size(settings%sizes)
    call keys%require(n == size(settings%fractions), 'fractions', &
                      'there must be as many as sizes: '//shown(n)//', not '//shown(size(settings%fractions)))
    call keys%require(all(settings%sizes(2:) > settings%sizes(:n - 1)), 'sizes', 'must rise')
  end subroutine declare_table

end module table_settings
